"""The same bytes from every instruction set, number of threads and size of tiles."""

import sys
from pathlib import Path

from program import QUICK, ROOT, Summary, arguments, run, run_json

HERE = Path(__file__).resolve().parent


def scenes(shared):
    """Name, file, options. The first two need nothing but this repository."""
    mitsuba, third = shared / "mitsuba-data" / "tests" / "scenes", shared / "scenes"
    return [
        ("medley", HERE / "medley.xml", ["--size", "64x48"]),
        ("medley, independent", HERE / "medley.xml", ["--size", "64x48", "--sampler", "independent"]),
        ("material-ball", ROOT / "scenes" / "material-ball" / "material-ball.xml", ["--size", "45x37"]),
        ("rgl-cornell-box", third / "rgl-cornell-box" / "scene_ref320.xml", ["--size", "48x48"]),
        ("rgl-veach-ajar", third / "rgl-veach-ajar" / "scene_ref320.xml", ["--size", "64x36"]),
        ("bitterli06-living-room", third / "bitterli06-living-room" / "scene_ref320.xml",
         ["--size", "64x36", "--sampler", "sobol"]),
        ("texture_interp", mitsuba / "texture_interp" / "test_texture_interp_direct.xml", []),
    ]


def variants(sets):
    """Of the instruction sets in ascending order: the reference first."""
    best = sets[-1]
    yield ["--isa", sets[0], "--threads", "1"]
    for name in sets[1:]:
        yield ["--isa", name, "--threads", "1"]
    for threads in ("2", "3"):
        yield ["--isa", best, "--threads", threads]
    for tile in ("1", "7", "32"):
        yield ["--isa", best, "--threads", "2", "--tile", tile]
    yield ["--isa", sets[0], "--threads", "3", "--tile", "5"]


def pixels(data):
    """Width, height and the bytes of the values of a PFM file."""
    head = data.split(b"\n", 3)
    width, height = map(int, head[1].split())
    return width, height, head[3]


def where(a, b):
    """Says how two PFM files differ."""
    width, height, left = pixels(a)
    other = pixels(b)
    if (width, height) != other[:2]:
        return f"sizes differ: {width} x {height} and {other[0]} x {other[1]}"
    differ = [i for i in range(width * height) if left[12 * i:12 * i + 12] != other[2][12 * i:12 * i + 12]]
    if not differ:
        return "the headers differ"
    return (f"{len(differ)} of {width * height} pixels differ, the first at "
            f"{differ[0] % width},{height - 1 - differ[0] // width}")


def same_bits(program, scene, words, sets, picture):
    expected, first, wrong, count = None, None, [], 0
    for variant in variants(sets):
        run(program, "render", scene, "-o", picture, "-q", "--spp", 2 if QUICK else 16, *words, *variant)
        data = picture.read_bytes()
        count += 1
        if expected is None:
            expected, first = data, variant
            if not any(pixels(data)[2]):
                return False, "the picture is black: nothing was compared", []
        elif data != expected:
            wrong.append(f"{' '.join(variant)} against {' '.join(first)}: {where(expected, data)}")
    if wrong:
        return False, "; ".join(wrong), []
    return True, f"{count} renders, the same {len(expected)} bytes", []


def main():
    options = arguments("The same bytes from every instruction set, thread count and tiling.")
    summary = Summary(options, "same bits")
    sets = run_json(options.program, "info", "--cpu", "--json")["instruction_sets"]
    print("instruction sets of this CPU:", ", ".join(sets), flush=True)
    for name, scene, words in scenes(options.shared):
        summary.scene(name, lambda: same_bits(options.program, scene, words, sets,
                                              summary.path("picture.pfm")), needs=(scene,))
    return summary.end()


if __name__ == "__main__":
    sys.exit(main())
