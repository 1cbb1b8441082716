"""RGL files that faceta writes, in Mitsuba 3.9.1's own reader: values and densities of `measured`
over random pairs of directions, the same in both programs to 1e-3.

    python3 measured.py PROGRAM [--pairs N]

Interpreter, skipping and exit codes as in materials.py.
"""

import argparse
import csv
import io
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import materials
from specs import single

SOURCES = {
    "gold": ["roughconductor", "material=Au", "alpha=0.2"],
    "almost a mirror": ["roughconductor", "material=Au", "alpha=0.01"],
    "plastic": ["roughplastic", "alpha=0.1", "diffuse_reflectance=0.1,0.2,0.6"],
    "clay": ["orennayar", "sigma=0.8"],
    "brushed": ["roughconductor", "material=Al", "alpha_u=0.1", "alpha_v=0.3"],
    "a table": ["demo:gloss"],
}
# What any value may be off by: both programs work in single precision, and sum up and invert
# distributions over thousands of texels in it.
RELATIVE, ABSOLUTE = 1e-3, 1e-5


def hemisphere(numbers):
    z, phi = numbers.uniform(0.02, 1), numbers.uniform(0, 2 * math.pi)
    r = math.sqrt(1 - z * z)
    return r * math.cos(phi), r * math.sin(phi), z


def pairs(numbers, count):
    """Half of them around the mirror direction, where lobes are."""
    while count > 0:
        wo, wi = hemisphere(numbers), hemisphere(numbers)
        if count % 2:
            m = [numbers.gauss(0, 0.1), numbers.gauss(0, 0.1), 1]
            size = math.hypot(*m)
            m = [x / size for x in m]
            cosine = sum(a * b for a, b in zip(wo, m))
            wi = tuple(2 * cosine * b - a for a, b in zip(wo, m))
        if wi[2] > 0.02:
            yield tuple(map(single, wo + wi))
            count -= 1


def ours(program, path, rows):
    lines = ["wo_x,wo_y,wo_z,wi_x,wi_y,wi_z", *(",".join(map(repr, row)) for row in rows), ""]
    result = subprocess.run([program, "eval", "measured", f"filename={path}"],
                            input="\n".join(lines), text=True, capture_output=True, check=True)
    columns = ("value_r", "value_g", "value_b", "pdf")
    return [[float(line[c]) for c in columns] for line in csv.DictReader(io.StringIO(result.stdout))]


def theirs(mi, path, rows):
    bsdf = mi.load_dict({"type": "measured", "filename": str(path)})
    context, point, result = mi.BSDFContext(), mi.SurfaceInteraction3f(), []
    point.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
    for row in rows:
        point.wi, light = mi.Vector3f(row[:3]), mi.Vector3f(row[3:])
        value = bsdf.eval(context, point, light)
        result.append([value[0], value[1], value[2], bsdf.pdf(context, point, light)])
    return result


def run_all(options):
    import mitsuba
    mitsuba.set_variant("scalar_rgb")
    worst_of_all = 0
    with tempfile.TemporaryDirectory(prefix="faceta_peer_") as folder:
        for name, source in SOURCES.items():
            path = Path(folder) / "written.bsdf"
            subprocess.run([options.program, "measure", "convert", *source, path], check=True,
                           stdout=subprocess.DEVNULL)
            rows = list(pairs(random.Random(name), options.pairs))
            a, b = ours(options.program, path, rows), theirs(mitsuba, path, rows)
            lit = sum(max(y[:3]) > ABSOLUTE for y in b)
            worst = max(abs(x - y) / (RELATIVE * max(abs(x), abs(y)) + ABSOLUTE)
                        for p, q in zip(a, b) for x, y in zip(p, q))
            worst_of_all = max(worst_of_all, worst if lit > len(rows) / 4 else math.inf)
            print(f"{name:18}{len(rows):6} pairs, {lit:6} lit: largest difference over what is "
                  f"allowed {worst:.3f}", flush=True)
    print("all agree" if worst_of_all <= 1 else "DIFFERENCES")
    return 0 if worst_of_all <= 1 else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="the faceta program")
    parser.add_argument("--pairs", type=int, default=4000, help="for each file (4000)")
    parser.add_argument("--environment", type=Path, default=materials.ROOT / "build" / "peer",
                        help="folder of the virtual environment (build/peer)")
    options = parser.parse_args()
    options.program = str(Path(options.program).resolve())
    return materials.run_inside(options, __file__, run_all)


if __name__ == "__main__":
    sys.exit(main())
