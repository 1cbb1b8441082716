"""Sampling rules beside Mitsuba 3.9.1's own: the coefficient of variation of the weights, for a grid
of roughnesses, distributions and viewers. No material at any viewer may be worse.

    python3 efficiency.py PROGRAM [--samples N] [--only MATERIAL]... [--all]

Interpreter, skipping and exit codes as in materials.py.
"""

import argparse
import math
import multiprocessing
import os
import random
import sys
import time
from pathlib import Path

import compare
import materials
from specs import Spec, single

# Squares of the variations may differ by so many standard errors, and by so much of themselves that
# no picture shows it. What seems worse is asked again with more samples.
SIGMAS, RELATIVE, ABSOLUTE = 4, 0.02, 1e-4
BATCHES, STAGES = 16, (1, 16, 128)
ANGLES = (0, 30, 60, 80, 89)


def microfacet(alphas, visible=True):
    for distribution in ("beckmann", "ggx"):
        for alpha in alphas:
            yield {"distribution": distribution, "alpha": single(alpha), "sample_visible": visible}


def grid():
    """The materials, with their names in the table."""
    rough = (0.01, 0.1, 0.3, 0.6, 1)
    colour = (single(0.9), single(0.4), single(0.1))
    yield Spec("diffuse", {"reflectance": colour})
    yield Spec("conductor", {"material": "Au"})
    yield Spec("dielectric", {"specular_reflectance": colour})
    yield Spec("thindielectric", {"specular_transmittance": colour})
    yield Spec("null")
    for visible in (True, False):
        for surface in microfacet(rough if visible else (0.1, 0.3), visible):
            yield Spec("roughconductor", {"material": "Au", **surface})
            yield Spec("roughdielectric", surface)
            yield Spec("roughdielectric", {"int_ior": "air", "ext_ior": "diamond", **surface})
            yield Spec("roughplastic", {"diffuse_reflectance": colour, **surface})
    for distribution in ("beckmann", "ggx"):
        brushed = {"distribution": distribution, "sample_visible": True,
                   "alpha_u": single(0.05), "alpha_v": single(0.4)}
        yield Spec("roughconductor", {"material": "Al", **brushed})
        yield Spec("roughdielectric", brushed)
    for nonlinear in (False, True):
        yield Spec("plastic", {"diffuse_reflectance": colour, "nonlinear": nonlinear})
    gold = Spec("roughconductor", {"material": "Au", "distribution": "ggx", "sample_visible": True,
                                   "alpha": single(0.3)})
    grey = Spec("diffuse", {"reflectance": (0.5, 0.5, 0.5)})
    yield Spec("twosided", {}, [gold])
    yield Spec("mask", {"opacity": single(0.6)}, [gold])
    yield Spec("blendbsdf", {"weight": single(0.4)}, [gold, grey])


def both_sides(spec):
    return "dielectric" in spec.type or spec.type in ("null", "twosided")


def squared_variation(weights):
    """The mean over the channels of (standard deviation / mean)^2."""
    total, channels, n = 0.0, 0, len(weights)
    for c in range(3):
        mean = math.fsum(w[c] for w in weights) / n
        if mean > 0:
            total += math.fsum((w[c] / mean - 1) ** 2 for w in weights) / n
            channels += 1
    return total / channels if channels else 0.0


def with_error(weights):
    """The squared variation and its variance, by the spread over batches."""
    parts = [squared_variation(weights[k::BATCHES]) for k in range(BATCHES)]
    mean = math.fsum(parts) / BATCHES
    spread = math.fsum((p - mean) ** 2 for p in parts) / (BATCHES - 1) / BATCHES
    return squared_variation(weights), spread


def study_viewer(spec, wo, numbers, samples):
    """(ours, Mitsuba's, whether ours is worse)."""
    for factor in STAGES:
        rows = [wo + tuple(single(numbers.random() * (1 - 2**-24)) for _ in range(3))
                for _ in range(samples * factor)]
        ours = with_error([s[1] for s in materials.OURS.sample(spec, "importance", rows)])
        theirs = with_error(compare.true_weights(materials.THEIRS, spec, "importance", rows))
        allowed = SIGMAS * math.sqrt(ours[1] + theirs[1]) + RELATIVE * theirs[0] + ABSOLUTE
        worse = ours[0] - theirs[0] > allowed
        if not worse:
            break
    return math.sqrt(ours[0]), math.sqrt(theirs[0]), worse


def study(job):
    spec, samples = job
    numbers = random.Random(str(spec))
    result = []
    for angle in ANGLES + tuple(180 - a for a in ANGLES if both_sides(spec)):
        theta, phi = math.radians(angle), 0.7
        wo = tuple(map(single, (math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi),
                                math.cos(theta))))
        result.append((angle, *study_viewer(spec, wo, numbers, samples)))
    return spec, result


def run_all(options):
    jobs = [(s, options.samples) for s in grid() if not options.only or s.type in options.only]
    worse, start = 0, time.monotonic()
    context = multiprocessing.get_context("spawn")
    with context.Pool(os.cpu_count(), materials.prepare, (options.program,)) as pool:
        for spec, points in pool.imap(study, jobs):
            bad = {a for a, _, _, is_worse in points if is_worse}
            worse += len(bad)
            if bad or options.all:
                cells = " ".join(f"{a}°:{ours:.3f}/{theirs:.3f}{'!' if a in bad else ''}"
                                 for a, ours, theirs, _ in points)
                print(f"{spec}\n  {cells}", flush=True)
    print(f"{len(jobs)} materials, ours / Mitsuba's: "
          f"{f'WORSE at {worse} viewers' if worse else 'none is worse'}, "
          f"{time.monotonic() - start:.0f} s")
    return 1 if worse else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="the faceta program")
    parser.add_argument("--samples", type=int, default=4000, help="for each viewer (4000)")
    parser.add_argument("--only", action="append", default=[], help="materials of this type")
    parser.add_argument("--all", action="store_true", help="show all, not only what is worse")
    parser.add_argument("--environment", type=Path, default=materials.ROOT / "build" / "peer",
                        help="folder of the virtual environment (build/peer)")
    options = parser.parse_args()
    options.program = str(Path(options.program).resolve())
    return materials.run_inside(options, __file__, run_all)


if __name__ == "__main__":
    sys.exit(main())
