"""Random directions: everywhere, grazing, and where narrow lobes are."""

import math

from specs import IORS, single


def rounded(x, y, z):
    length = math.sqrt(x * x + y * y + z * z)
    return (single(x / length), single(y / length), single(z / length))


def sphere(random):
    z = random.uniform(-1, 1)
    if random.random() < 0.1:
        z *= 0.02
    sine, phi = math.sqrt(1 - z * z), random.uniform(0, 2 * math.pi)
    return rounded(sine * math.cos(phi), sine * math.sin(phi), z)


def index_of(value):
    return IORS.get(value, value)


class Lobes:
    """What of a material tells where its light goes: roughness and index."""

    def __init__(self, spec):
        self.alphas, self.eta, self.below = [], None, False
        self.collect(spec)

    def collect(self, spec):
        p = spec.params
        if "distribution" in p:
            self.alphas.append((p.get("alpha", p.get("alpha_u")), p.get("alpha", p.get("alpha_v"))))
        if spec.type in ("roughdielectric", "dielectric", "thindielectric"):
            self.eta = index_of(p.get("int_ior", "bk7")) / index_of(p.get("ext_ior", "air"))
        self.below = self.below or self.eta is not None or spec.type == "twosided"
        for child in spec.children:
            self.collect(child)

    def viewer(self, random):
        x, y, z = sphere(random)
        return (x, y, z if z < 0 and random.random() < (1 if self.below else 0.05) else abs(z))

    def normal(self, random):
        """A normal whose slopes are those of the surface."""
        u, v = random.choice(self.alphas) if self.alphas else (0.3, 0.3)
        scale = math.sqrt(0.5)
        return rounded(u * random.gauss(0, scale), v * random.gauss(0, scale), 1)

    def light(self, random, wo):
        """Anywhere, or reflected or refracted by a likely normal."""
        kind = random.random()
        if kind < 0.35:
            x, y, z = sphere(random)
            same = self.below or random.random() < 0.05
            return (x, y, z if same else math.copysign(z, wo[2]))
        m = self.normal(random)
        cosine = sum(a * b for a, b in zip(wo, m))
        if self.eta is None or kind < 0.7:
            return rounded(*(2 * cosine * b - a for a, b in zip(wo, m)))
        ratio = 1 / self.eta if cosine > 0 else self.eta
        squared = 1 - ratio * ratio * (1 - cosine * cosine)
        if squared <= 0:
            return sphere(random)
        k = ratio * cosine - math.copysign(math.sqrt(squared), cosine)
        return rounded(*(k * b - ratio * a for a, b in zip(wo, m)))
