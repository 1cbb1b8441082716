"""Random parameter sets of the materials that both programs have, as trees of plain values.

Numbers are single-precision ones: both programs read exactly the same.
"""

import math
import struct
from dataclasses import dataclass, field, replace


def single(x):
    """The nearest single-precision number."""
    return struct.unpack("f", struct.pack("f", x))[0]


def neighbour(x, up):
    """The next single-precision number above or below."""
    if x == 0:
        return math.copysign(2.0**-149, 1 if up else -1)
    bits = struct.unpack("i", struct.pack("f", x))[0]
    return struct.unpack("f", struct.pack("i", bits + (1 if (x > 0) == up else -1)))[0]


@dataclass
class Spec:
    """A material: type, parameters (float, tuple of three, str, bool), nested materials."""

    type: str
    params: dict = field(default_factory=dict)
    children: list = field(default_factory=list)

    def xml(self, attributes=""):
        parts = [f'<bsdf type="{self.type}"{attributes}>']
        for name, value in self.params.items():
            if isinstance(value, bool):
                parts.append(f'<boolean name="{name}" value="{str(value).lower()}"/>')
            elif isinstance(value, str):
                parts.append(f'<string name="{name}" value="{value}"/>')
            elif isinstance(value, tuple):
                parts.append(f'<rgb name="{name}" value="{text(value)}"/>')
            else:
                parts.append(f'<float name="{name}" value="{text(value)}"/>')
        parts += [child.xml() for child in self.children]
        return "".join(parts) + "</bsdf>"

    def settings(self):
        """As on the command line."""
        return [f"{name}={text(value)}" for name, value in self.params.items()]

    def __str__(self):
        inner = ", ".join(map(str, self.children))
        return " ".join([self.type, *self.settings()]) + (f" ({inner})" if inner else "")

    def neighbours(self):
        """Pairs of this material with one number a unit in the last place up and down; colours
        with all three channels at once."""
        for name, value in self.params.items():
            if isinstance(value, (bool, str)):
                continue
            pair = []
            for up in (True, False):
                if isinstance(value, tuple):
                    moved = tuple(move_colour(name, x, up) for x in value)
                else:
                    moved = neighbour(value, up)
                pair.append(replace(self, params={**self.params, name: moved}))
            yield pair
        for i, child in enumerate(self.children):
            for pair in child.neighbours():
                yield [replace(self, children=[*self.children[:i], c, *self.children[i + 1:]])
                       for c in pair]


def move_colour(name, x, up):
    moved = neighbour(x, up)
    inside = 0 <= moved <= 1 if "reflectance" in name or "transmittance" in name else moved >= 0
    return moved if inside else x


def text(value):
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return ",".join(map(text, value))
    return value if isinstance(value, str) else repr(value)


METALS = (
    "a-C Ag Al AlAs AlAs_palik AlSb AlSb_palik Au Be Be_palik Cr CsI CsI_palik Cu Cu_palik Cu2O "
    "Cu2O_palik CuO CuO_palik d-C d-C_palik Hg Hg_palik HgTe HgTe_palik Ir Ir_palik K K_palik Li "
    "Li_palik MgO MgO_palik Mo Mo_palik Na_palik Nb Nb_palik Ni_palik Rh Rh_palik Se Se_palik Se-e "
    "Se-e_palik SiC SiC_palik SnTe SnTe_palik Ta Ta_palik Te Te_palik Te-e Te-e_palik ThF4 "
    "ThF4_palik TiC TiC_palik TiN TiN_palik TiO2 TiO2_palik TiO2-e TiO2-e_palik VC VC_palik "
    "V_palik VN VN_palik W").split()
IORS = {"vacuum": 1.0, "air": 1.000277, "water": 1.333, "bk7": 1.5046, "diamond": 2.419,
        "polypropylene": 1.49, "acrylic glass": 1.49, "sodium chloride": 1.544}


class Generator:
    """Draws parameter sets; the n-th one of a material is the same whatever else is drawn."""

    def __init__(self, random, index):
        self.random, self.index = random, index

    def log(self, low, high):
        return single(math.exp(self.random.uniform(math.log(low), math.log(high))))

    def colour(self):
        kind = self.random.random()
        if kind < 0.15:
            return (1.0, 1.0, 1.0)
        if kind < 0.2:
            return (0.0, 0.0, single(self.random.random()))
        return tuple(single(self.random.random()) for _ in range(3))

    def flag(self, probability=0.5):
        return self.random.random() < probability

    def tints(self, *names):
        return {name: self.colour() for name in names if self.flag(0.7)}

    def indices(self, inverted=True, high=2.5):
        if self.flag(0.2):
            inside, outside = self.random.sample(sorted(IORS), 2)
            while max(IORS[inside], IORS[outside]) < 1.05 * min(IORS[inside], IORS[outside]):
                inside = self.random.choice(sorted(IORS))
            if IORS[inside] < IORS[outside] and not inverted:
                inside, outside = outside, inside
            return {"int_ior": inside, "ext_ior": outside}
        outside = self.log(1, 1.4) if self.flag() else 1.0
        inside = single(outside * self.random.uniform(1.05, high))
        if inverted and self.flag(0.3):
            inside, outside = outside, inside
        return {"int_ior": inside, "ext_ior": outside}

    def surface(self, anisotropic=True):
        params = {"distribution": self.random.choice(["beckmann", "ggx"]),
                  "sample_visible": self.flag(0.7)}
        if anisotropic and self.flag(0.4):
            params |= {"alpha_u": self.log(0.01, 1), "alpha_v": self.log(0.01, 1)}
        else:
            params["alpha"] = self.log(0.01, 1)
        return params

    def metal(self):
        # Every named metal comes once in each 2 x 71 sets.
        if self.index % 2 == 0:
            return {"material": METALS[self.index // 2 % len(METALS)]}
        if self.flag(0.1):
            return {}
        return {"eta": tuple(single(self.random.uniform(0.05, 4)) for _ in range(3)),
                "k": tuple(single(self.random.uniform(0, 8)) for _ in range(3))}

    # --- One function a material ---

    def diffuse(self):
        return Spec("diffuse", {"reflectance": self.colour()})

    def conductor(self):
        return Spec("conductor", self.metal() | self.tints("specular_reflectance"))

    def roughconductor(self):
        return Spec("roughconductor",
                    self.metal() | self.surface() | self.tints("specular_reflectance"))

    def dielectric(self):
        return Spec("dielectric", self.indices()
                    | self.tints("specular_reflectance", "specular_transmittance"))

    def thindielectric(self):
        return Spec("thindielectric", self.indices()
                    | self.tints("specular_reflectance", "specular_transmittance"))

    def roughdielectric(self):
        return Spec("roughdielectric", self.indices() | self.surface()
                    | self.tints("specular_reflectance", "specular_transmittance"))

    def plastic(self):
        return Spec("plastic", self.indices(inverted=False) | {"nonlinear": self.flag()}
                    | self.tints("diffuse_reflectance", "specular_reflectance"))

    def roughplastic(self):
        return Spec("roughplastic", self.indices(inverted=False) | {"nonlinear": self.flag()}
                    | self.surface(anisotropic=False)
                    | self.tints("diffuse_reflectance", "specular_reflectance"))

    def null(self):
        return Spec("null")

    def opaque(self):
        return self.random.choice([self.diffuse, self.roughconductor, self.plastic,
                                   self.roughplastic])()

    def twosided(self):
        children = [self.opaque() for _ in range(1 + self.flag())]
        return Spec("twosided", {}, children)

    def mask(self):
        child = self.random.choice([self.opaque, self.roughdielectric, self.twosided])()
        return Spec("mask", {"opacity": single(self.random.random())}, [child])

    def blendbsdf(self):
        kinds = [self.opaque, self.opaque, self.roughdielectric, self.conductor]
        children = [self.random.choice(kinds)() for _ in range(2)]
        return Spec("blendbsdf", {"weight": single(self.random.random())}, children)


MATERIALS = ("diffuse", "conductor", "roughconductor", "dielectric", "thindielectric",
             "roughdielectric", "plastic", "roughplastic", "twosided", "mask", "blendbsdf", "null")
