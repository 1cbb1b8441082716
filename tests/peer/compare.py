"""One random parameter set of one material in both programs."""

import math
import random
from dataclasses import dataclass, field, replace

from directions import Lobes, index_of
from specs import Generator, Spec, neighbour, single

EXPLAINED = """Differences whose reason was found, and how each is bounded:
- Density of Beckmann's visible normals: Mitsuba puts the rational fit of the masking in it, ours
  is the exact one, which integrates to 1. Within 0.35 %, the error of the fit.
- Mean weight of roughdielectric with sample_visible=false: Mitsuba draws from a distribution
  widened by 1.2 - 0.2 sqrt|cos|, but its weight leaves out the quotient of the two distributions
  (weight x pdf differs from its own eval by up to a factor of 3). Its eval / pdf is taken instead.
- Mean weight of blendbsdf around a delta lobe: Mitsuba 3.9.1 adds the lobe's discrete probability
  to the other material's density per solid angle. The blended means of its children are taken.
- 1 - F near the horizon, 1 - T of roughplastic's table: Mitsuba subtracts in single precision,
  which costs up to 5 x 2^-24 / (1 - F) of the value or the density: its own fresnel() is off by up
  to 4.2 x 2^-24 (20 000 cosines from 1e-6 to 0.1 for each of five indices).
- Density of roughplastic with visible normals of GGX: ours bounds them to those that reflect
  upwards, the rule is another one. Not compared. (roughconductor has a parameter for it.)"""

RELATIVE = 1e-4
# Below this both are black: single precision ends, and both programs cut off somewhere above.
BLACK = 1e-9
VIEWERS = 4
DELTAS = ("conductor", "dielectric", "thindielectric", "null")
# Means further apart than so many standard errors are asked again, with so many times the samples:
# the weights of some rules have tails too long for the few of the first time.
SUSPICIOUS, STAGES = 4.5, (1, 20, 400)
CHANNELS = ("red", "green", "blue", "density")


@dataclass
class Difference:
    ratio: float  # over what is allowed
    text: str


@dataclass
class Means:
    """Of the sampled weights, for one viewer and channel."""

    ours: float
    theirs: float
    variance: float  # of the mean of the paired differences
    text: str

    def z(self):
        """How many standard errors lie between the means, beyond the relative tolerance."""
        allowed = RELATIVE * max(abs(self.ours), abs(self.theirs)) + BLACK
        return max(abs(self.ours - self.theirs) - allowed, 0) / max(self.variance**0.5, 1e-12)


@dataclass
class Result:
    material: str
    index: int
    spec: str
    pairs: int = 0
    moved: int = 0  # compared with what a unit in the last place moves
    samples: int = 0
    worst: Difference = field(default_factory=lambda: Difference(0, ""))
    means: list = field(default_factory=list)
    error: str = ""

    def note(self, ratio, text):
        if not ratio <= self.worst.ratio:
            self.worst = Difference(ratio, text)


def unbounded(spec):
    """The same material with the sampling rule of GGX that Mitsuba has: the density's, not the
    value's business."""
    params = dict(spec.params)
    if spec.type == "roughconductor":
        params["bounded_sampling"] = False
    return Spec(spec.type, params, [unbounded(child) for child in spec.children])


def density_tolerance(spec):
    """Relative; huge where the sampling rules differ."""
    p, result = spec.params, RELATIVE
    if p.get("sample_visible"):
        if p["distribution"] == "beckmann":
            result = 0.0035
        elif spec.type == "roughplastic":
            result = 1e9
    return max([result, *map(density_tolerance, spec.children)])


def any_of(spec, test):
    return test(spec) or any(any_of(child, test) for child in spec.children)


def interfaces(spec):
    """Type and relative index of all that has any."""
    p = spec.params
    if "int_ior" in p:
        yield spec.type, index_of(p["int_ior"]) / index_of(p["ext_ior"])
    for child in spec.children:
        yield from interfaces(child)


def transmittance(cosine, eta):
    """1 - F of a smooth interface, without its cancellation."""
    eta = eta if cosine > 0 else 1 / eta
    c = abs(cosine)
    t2 = c * c + eta * eta - 1
    if t2 <= 0 or c == 0:
        return 0.0
    t = math.sqrt(t2) # eta cos_t
    return 2 * c * t * (1 / (c + t) ** 2 + eta ** 2 / (eta ** 2 * c + t) ** 2)


def lost_digits(spec, row):
    """Relative error of Mitsuba's value and density by its subtractions in single precision."""
    value = density = 0.0
    for kind, eta in interfaces(spec):
        for cosine in (row[2], row[5]):
            passed = transmittance(cosine if "dielectric" in kind else abs(cosine), eta)
            value += 5 * 2**-24 / passed if passed > 0 else 0
        if kind == "roughplastic":
            density += 2**-22 / max(1 - transmittance(abs(row[2]), eta), 1e-5)
    return (value,) * 3 + (value + density,)


class Comparison:
    def __init__(self, ours, theirs, material, index, pairs, seed):
        self.ours, self.theirs = ours, theirs
        self.random = random.Random(f"{seed} {material} {index}")
        self.spec = getattr(Generator(self.random, index), material)()
        self.mode = "radiance" if self.random.random() < 0.7 else "importance"
        self.lobes = Lobes(self.spec)
        self.pairs = pairs
        self.result = Result(material, index, f"{self.spec} --mode {self.mode}")

    def run(self):
        self.values()
        self.weights()
        return self.result

    # --- Values and densities ---

    def values(self):
        rows = []
        for _ in range(self.pairs):
            wo = self.lobes.viewer(self.random)
            rows.append(wo + self.lobes.light(self.random, wo))
        own = unbounded(self.spec)
        relative = (RELATIVE, RELATIVE, RELATIVE, density_tolerance(self.spec))
        tolerances = [tuple(map(sum, zip(lost_digits(self.spec, r), relative))) for r in rows]
        self.result.pairs = len(rows)
        a = self.ours.evaluate(own, self.mode, rows)
        b = self.theirs.evaluate(self.spec, self.mode, rows)
        ratios = list(map(excess, a, b, tolerances))
        doubtful = [i for i, ratio in enumerate(ratios) if not ratio <= 1]
        self.result.moved = len(doubtful)
        self.result.note(max((r for r in ratios if r <= 1), default=0), "")
        if not doubtful:
            return
        some = [rows[i] for i in doubtful]
        moved = self.moved(own, some, 6, lambda side, spec, r: side.evaluate(spec, self.mode, r))
        for k, i in enumerate(doubtful):
            ratio, channel = worst_channel(a[i], b[i], tolerances[i], moved[k])
            self.result.note(ratio, f"{CHANNELS[channel]} {a[i][channel]:.8g}, Mitsuba "
                             f"{b[i][channel]:.8g}, an ulp moves it by {moved[k][channel]:.2g}, at "
                             f"wo,wi {','.join(map(repr, rows[i]))}")

    def moved(self, own, rows, directions, evaluate):
        """What a unit in the last place of every input moves either program, together: a tuple for
        each row."""
        total = None
        for side, spec in ((self.ours, own), (self.theirs, self.spec)):
            center = evaluate(side, spec, rows)
            pairs = []
            for c in range(directions):
                pairs.append([evaluate(side, spec, [nudged(r, c, up) for r in rows])
                              for up in (True, False)])
            for pair in spec.neighbours():
                pairs.append([evaluate(side, s, rows) for s in pair])
            if total is None:
                total = [[0.0] * len(c) for c in center]
            for up, down in pairs:
                for t, c, x, y in zip(total, center, up, down):
                    for j in range(len(t)):
                        t[j] += max(abs(x[j] - c[j]), abs(y[j] - c[j]))
        return total

    # --- Samples ---

    def weights(self):
        count = max(self.pairs // VIEWERS, 1)
        for _ in range(VIEWERS):
            wo = self.lobes.viewer(self.random)
            rows = self.numbers(wo, count)
            a = self.ours.sample(self.spec, self.mode, rows)
            b = self.theirs.sample(self.spec, self.mode, rows)
            self.result.samples += count
            if self.spec.type in DELTAS:
                self.deltas(rows, a, b)
            self.means(wo, count)

    def numbers(self, wo, count):
        return [wo + tuple(single(self.random.random() * (1 - 2**-24)) for _ in range(3))
                for _ in range(count)]

    def means(self, wo, count):
        """Means over more and more fresh numbers, as long as they seem to differ."""
        for stage, factor in enumerate(STAGES):
            rows = self.numbers(wo, count * factor)
            ours = [s[1] for s in self.ours.sample(self.spec, self.mode, rows)]
            theirs = true_weights(self.theirs, self.spec, self.mode, rows)
            means = [Means(*paired(ours, theirs, c), f"{CHANNELS[c]} for wo {wo}")
                     for c in range(3)]
            if stage == 0:
                self.result.means += means
            worst = max(means, key=Means.z)
            if worst.z() <= SUSPICIOUS:
                return
        self.result.note(worst.z() / SUSPICIOUS, f"mean weight {worst.ours:.6g}, Mitsuba "
                         f"{worst.theirs:.6g}, standard error {worst.variance ** 0.5:.2g}, "
                         f"{worst.text}")

    def deltas(self, rows, a, b):
        """The same random numbers lead to the same sample."""
        numbers = lambda s: (*s[0], *s[1], s[2])
        tolerance = (RELATIVE,) * 7
        doubtful = []
        for i, (x, y) in enumerate(zip(a, b)):
            if x[3:] != y[3:]:
                share = x[2] if x[3] == "reflection" else 1 - x[2]
                if abs(rows[i][5] - share) > 1e-5:
                    self.result.note(math.inf, f"lobe {x[3]}, Mitsuba {y[3]}, at {rows[i]}")
            elif excess(numbers(x), numbers(y), tolerance) > 1:
                doubtful.append(i)
        if not doubtful:
            return
        some = [rows[i] for i in doubtful]
        evaluate = lambda side, spec, r: list(map(numbers, side.sample(spec, self.mode, r)))
        moved = self.moved(self.spec, some, 3, evaluate)
        for k, i in enumerate(doubtful):
            x, y = numbers(a[i]), numbers(b[i])
            ratio, j = worst_channel(x, y, tolerance, moved[k])
            name = ("x", "y", "z", "red weight", "green weight", "blue weight", "probability")[j]
            self.result.note(ratio, f"{name} {x[j]:.8g}, Mitsuba {y[j]:.8g}, an ulp moves it by "
                             f"{moved[k][j]:.2g}, at {rows[i]}")


def paired(ours, theirs, channel):
    """Both means, and the variance of the mean of their differences."""
    a, b = [w[channel] for w in ours], [w[channel] for w in theirs]
    n = len(a)
    differences = [x - y for x, y in zip(a, b)]
    mean = math.fsum(differences) / n
    return (math.fsum(a) / n, math.fsum(b) / n,
            math.fsum((d - mean) ** 2 for d in differences) / max(n - 1, 1) / n)


def true_weights(theirs, spec, mode, rows):
    """Mitsuba's sampled weights, or what they should be (EXPLAINED)."""
    is_delta = lambda s: s.type in (*DELTAS, "plastic")
    if spec.type == "blendbsdf" and any_of(spec, is_delta):
        w = spec.params["weight"]
        first, second = (true_weights(theirs, child, mode, rows) for child in spec.children)
        return [tuple((1 - w) * x + w * y for x, y in zip(p, q)) for p, q in zip(first, second)]
    wrong = lambda s: s.type == "roughdielectric" and not s.params["sample_visible"]
    if spec.type == "mask" and any_of(spec, wrong):
        opacity = spec.params["opacity"]
        inner = true_weights(theirs, spec.children[0], mode, rows)
        return [tuple(opacity * x + 1 - opacity for x in w) for w in inner]
    samples = theirs.sample(spec, mode, rows)
    if not any_of(spec, wrong):
        return [s[1] for s in samples]
    evals = theirs.evaluate(spec, mode, [r[:3] + s[0] for r, s in zip(rows, samples)])
    # A normal that faces away leads to a direction of weight 0, where eval belongs to another one.
    return [tuple(x / e[3] for x in e[:3]) if e[3] > 0 and any(s[1]) else (0.0,) * 3
            for s, e in zip(samples, evals)]


def nudged(row, component, up):
    return row[:component] + (neighbour(row[component], up),) + row[component + 1:]


def allowed(x, y, relative):
    return relative * max(abs(x), abs(y)) + BLACK


def excess(a, b, tolerance):
    """The largest difference over what is allowed."""
    return max(abs(x - y) / allowed(x, y, t) if math.isfinite(x) and math.isfinite(y) else math.inf
               for x, y, t in zip(a, b, tolerance))


def worst_channel(a, b, tolerance, moved):
    ratios = [abs(x - y) / (allowed(x, y, t) + m) if math.isfinite(x) and math.isfinite(y)
              else math.inf for x, y, t, m in zip(a, b, tolerance, moved)]
    worst = max(range(len(ratios)), key=ratios.__getitem__)
    return ratios[worst], worst
