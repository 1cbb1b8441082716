"""Real scenes against pictures by Mitsuba 3.9.1, both with their variances.

Per channel the means agree within 1 %, and at most 1 % of the means of 8 x 8 blocks lie beyond
|z| = 4 under both variances. The stored references are rounded to a relative 2.5e-4.
"""

import sys

from program import QUICK, Summary, arguments, run, run_json

QUANTISATION = 2.5e-4

# Samples per pixel: about as noisy as the reference, as far as the time allows.
SCENES = {
    "rgl-cornell-box": 512,
    "rgl-veach-mis": 512,
    "rgl-veach-ajar": 512,
    "rgl-teapot": 512,
    "bitterli06-living-room": 384,
    "coffee": 384,
}


# Differences whose reason was found.
KNOWN = {
    "coffee":
        "light leaks into the thin shell around 208,96 in Mitsuba, whose rays start a distance "
        "away that does not shrink with the scene; 1000 times larger, Mitsuba's agrees with ours",
}


def compare(program, scene, spp, reference, variance, picture, picture_variance):
    run(program, "render", scene, "-o", picture, "--float", "--variance", picture_variance,
        "--spp", spp, "--seed", 1, "-q")
    test = run_json(program, "diff", picture, reference, "--image-variance", picture_variance,
                    "--reference-variance", variance, "--quantisation", QUANTISATION, "--json",
                    codes=(0, 1))["two_sample_test"]
    ratios = " ".join(f"{channel} {100 * (ratio - 1):+.3f} % (z {z:+.1f})" for channel, ratio, z in
                      zip(test["channels"], test["mean_ratio"], test["mean_z"]))
    at = test["largest_block_at"]
    line = (f"{100 * test['block_share']:.3f} % of blocks beyond {test['limit']:g}, largest block z "
            f"{test['largest_block_z']:.1f} at {at['x']},{at['y']}; means {ratios}; {spp} spp")
    hints = []
    if test["non_finite"]:
        hints.append(f"{test['non_finite']} values are not finite")
    if abs(test["largest_block_z"]) > 8:
        hints.append("a block is far off")
    return test["pass"] and not test["non_finite"], line, hints


def main():
    options = arguments("Real scenes against Mitsuba's pictures.")
    summary = Summary(options, "references")
    for name, spp in SCENES.items():
        folder = options.shared / "scenes" / name
        scene = folder / "scene_ref320.xml"
        reference = folder / "reference_mitsuba_rgb.exr"
        variance = folder / "reference_mitsuba_rgb_var.exr"
        spp = max(2, spp // 16) if QUICK else spp
        summary.scene(name, lambda: compare(options.program, scene, spp, reference, variance,
                                            summary.path(name + ".exr"),
                                            summary.path(name + "_var.exr")),
                      needs=(scene, reference, variance))
    return summary.end(KNOWN)


if __name__ == "__main__":
    sys.exit(main())
