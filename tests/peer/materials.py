"""Mitsuba 3.9.1 as a live peer: random parameter sets of every material that both programs have.

Values and densities over random pairs of directions agree to 1e-4 relative beyond what one unit in
the last place of any input moves either program, and so do deltas drawn by the same numbers; means
of the sampled weights agree within their standard errors. Explained differences: compare.py.

    python3 materials.py PROGRAM [--sets N] [--only MATERIAL]... [--list-explained]

The peer's interpreter is $FACETA_PEER_PYTHON, or that of an environment which this script makes
once (--environment) with the wheel from PyPI. Where neither is to be had it says so and ends with
77. Ends with 1 if something differs.
"""

import argparse
import math
import multiprocessing
import os
import subprocess
import sys
import time
from pathlib import Path

import compare
import specs

SKIPPED = 77
WHEEL = "mitsuba==3.9.1"
ROOT = Path(__file__).resolve().parents[2]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="the faceta program")
    parser.add_argument("--sets", type=int, default=200, help="parameter sets a material (200)")
    parser.add_argument("--pairs", type=int, default=2000, help="direction pairs a set (2000)")
    parser.add_argument("--only", action="append", default=[], choices=specs.MATERIALS)
    parser.add_argument("--first", type=int, default=0, help="number of the first set (0)")
    parser.add_argument("--seed", default="1", help="of everything random (1)")
    parser.add_argument("--environment", type=Path, default=ROOT / "build" / "peer",
                        help="folder of the virtual environment (build/peer)")
    parser.add_argument("--list-explained", action="store_true")
    return parser.parse_args()


def importable(python):
    """Whether this interpreter has the peer, in its version."""
    code = f"import mitsuba; raise SystemExit(mitsuba.__version__ != {WHEEL.split('==')[1]!r})"
    try:
        return subprocess.run([python, "-c", code], capture_output=True, check=False).returncode == 0
    except OSError:
        return False


def skip(reason):
    print(f"skipped: {WHEEL} cannot be had: {reason}")
    sys.exit(SKIPPED)


def peer_python(folder):
    given = os.environ.get("FACETA_PEER_PYTHON")
    if given:
        return given if importable(given) else skip(f"not in FACETA_PEER_PYTHON={given}")
    python = folder / "bin" / "python"
    if importable(python):
        return str(python)
    print(f"Installing {WHEEL} into {folder}", flush=True)
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check",
           "--only-binary", ":all:", "--retries", "1", "--timeout", "20", WHEEL]
    for command in ([sys.executable, "-m", "venv", "--clear", folder], pip):
        made = subprocess.run(command, capture_output=True, text=True, check=False)
        if made.returncode:
            lines = (made.stderr + made.stdout).strip().splitlines() or ["no message"]
            skip(next((line for line in lines if "ERROR" in line), lines[-1]).strip())
    return str(python) if importable(python) else skip("the installed one does not load")


# --- In the peer's interpreter ---

def prepare(program):
    global OURS, THEIRS
    import sides
    OURS, THEIRS = sides.Faceta(program), sides.Mitsuba()


def run_one(job):
    import sides
    material, index, pairs, seed = job
    try:
        return compare.Comparison(OURS, THEIRS, material, index, pairs, seed).run()
    except sides.Failure as failure:
        return compare.Result(material, index, "", error=str(failure))


def report(material, results, seconds):
    """The line of a material; True if all is well."""
    wrong = [r for r in results if r.error or not r.worst.ratio <= 1]
    worst = max((r.worst.ratio for r in results if not r.error), default=math.inf)
    # Differences of all means together, each weighed by its certainty.
    weight = lambda m: 1 / (m.variance + (1e-3 * m.theirs) ** 2 + 1e-12)
    means = [m for r in results for m in r.means if m.theirs > 0.01]
    total = sum(weight(m) * m.theirs for m in means)
    bias = sum(weight(m) * (m.ours - m.theirs) for m in means) / total if means else 0
    print(f"{material:16}{len(results):5} sets {sum(r.pairs for r in results):8} pairs "
          f"{sum(r.moved for r in results):7} by ulps {sum(r.samples for r in results):8} samples  "
          f"worst {worst:7.3f}  mean weight {100 * bias:+8.4f} %  {seconds:5.0f} s"
          + (f"  {len(wrong)} DIFFER" if wrong else ""), flush=True)
    for r in wrong[:10]:
        print(f"  set {r.index}: {r.spec}\n    {r.error or f'{r.worst.ratio:.3g} x {r.worst.text}'}")
    return not wrong


def run_all(options):
    materials = options.only or specs.MATERIALS
    start, good = time.monotonic(), True
    context = multiprocessing.get_context("spawn")
    print("worst: difference over what is allowed; by ulps: pairs beyond 1e-4, held to what a unit "
          "in the last place moves")
    with context.Pool(os.cpu_count(), prepare, (options.program,)) as pool:
        for material in materials:
            begin = time.monotonic()
            indices = range(options.first, options.first + options.sets)
            jobs = [(material, i, options.pairs, options.seed) for i in indices]
            results = pool.map(run_one, jobs, chunksize=1)
            good = report(material, results, time.monotonic() - begin) and good
    print(f"{'all agree' if good else 'DIFFERENCES'}, {time.monotonic() - start:.0f} s")
    return 0 if good else 1


def run_inside(options, script, function):
    """function(options), in the peer's interpreter."""
    if not Path(options.program).is_file():
        print(f"no program {options.program}", file=sys.stderr)
        return 2
    if os.environ.get("FACETA_PEER_INSIDE") == "1":
        return function(options)
    python = peer_python(options.environment)
    os.environ["FACETA_PEER_INSIDE"] = "1"
    return subprocess.run([python, "-B", script, *sys.argv[1:]], check=False).returncode


def main():
    options = arguments()
    options.program = str(Path(options.program).resolve())
    if options.list_explained:
        print(compare.EXPLAINED)
        return 0
    return run_inside(options, __file__, run_all)


if __name__ == "__main__":
    sys.exit(main())
