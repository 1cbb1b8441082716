"""Mitsuba's acceptance test: its own small scenes against its own converged references.

As in Mitsuba's src/render/tests/test_renders.py: the part of a scene's name after the last "_" is
its integrator, two million samples go into a picture, and 99.75 % of all pixel channels (in XYZ)
must agree with the reference under its variance, the significance level of 1 % being divided among
the pixels. That rule alone is weak. So the largest |z| and the z of the image mean are shown too,
and called out above 6 and 4.
"""

import sys

from program import QUICK, Summary, arguments, run, run_json

SAMPLES = 200_000 if QUICK else 2_000_000
LARGEST_Z, LARGEST_MEAN_Z = 6, 4

SCENES = [
    "bsdf_spheres/test_arealight_path",
    "bsdf_spheres/test_constant_path",
    "bsdf_spheres/test_envmap_path",
    "bsdf_spheres/test_pointlight_path",
    "bsdf_spheres/test_roughdielectric_path",
    "bsdf_spheres/test_roughplastic_linear_path",
    "bsdf_spheres/test_roughplastic_nonlinear_path",
    "bsdf_spheres/test_textured_diffuse_path",
    "bsdf_spheres/test_textured_roughconductor_path",
    "infinite_mirrors/scene_path",
    "texture_interp/test_texture_interp_direct",
]


# Differences whose reason was found.
KNOWN = {
    "bsdf_spheres/test_constant_path":
        "the reference, by Mitsuba 2, has 0.1 % more red; Mitsuba 3.9.1 differs from it as we do",
    "texture_interp/test_texture_interp_direct":
        "the reference took the Gaussian filter from a table of 31 steps, as scalar Mitsuba does; "
        "Mitsuba's LLVM variant computes it and agrees with us",
}


def z_test(program, scene, integrator, reference, variance, picture):
    info = run_json(program, "info", reference, "--json")
    spp = SAMPLES // (info["width"] * info["height"])
    run(program, "render", scene, "-o", picture, "--float", "-q", f"-Dspp={spp}",
        f"-Dintegrator={integrator}")
    test = run_json(program, "diff", picture, reference, "--variance", variance, "--spp", spp,
                    "--json", codes=(0, 1))["z_test"]
    at, mean_z = test["largest_at"], max(test["mean_z"], key=abs)
    line = (f"{100 * test['pass_share']:8.4f} % pass, largest z {test['largest_z']:6.2f} at "
            f"{at['x']},{at['y']} {at['channel']}, z of the mean {mean_z:5.2f}, {spp} spp")
    hints = []
    if abs(test["largest_z"]) > LARGEST_Z:
        hints.append(f"the largest |z| is above {LARGEST_Z}")
    if abs(mean_z) > LARGEST_MEAN_Z:
        hints.append(f"the |z| of the mean is above {LARGEST_MEAN_Z}")
    return test["pass"], line, hints


def main():
    options = arguments("Mitsuba's acceptance test.")
    root = options.shared / "mitsuba-data" / "tests" / "scenes"
    summary = Summary(options, "z-test")
    for name in SCENES:
        scene = root / (name + ".xml")
        base, integrator = scene.stem.rsplit("_", 1)
        reference = scene.parent / "refs" / f"{base}_ref_rgb.exr"
        variance = scene.parent / "refs" / f"{base}_ref_rgb_var.exr"
        picture = summary.path(scene.stem + ".exr")
        summary.scene(name, lambda: z_test(options.program, scene, integrator, reference, variance,
                                           picture), needs=(scene, reference, variance))
    return summary.end(KNOWN)


if __name__ == "__main__":
    sys.exit(main())
