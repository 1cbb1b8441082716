"""faceta plot: kinds, pictures, materials, what is refused."""

import struct
import xml.etree.ElementTree as ElementTree

from program import INPUT_ERROR, OK, USAGE, Case, main, run

SVG = "{http://www.w3.org/2000/svg}"
KINDS = ["polar", "albedo", "slices", "density", "weight", "reciprocity"]


def texts(svg):
    return [node.text for node in ElementTree.fromstring(svg).iter(SVG + "text")]


def png_size(path):
    data = path.read_bytes()
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    return struct.unpack(">II", data[16:24])


class Plot(Case):
    def test_list(self):
        lines = self.succeed("plot", "--list").splitlines()
        self.assertEqual([line.split()[0] for line in lines[::2]], KINDS)

    def test_every_kind_as_svg_and_png(self):
        for kind in KINDS:
            with self.subTest(kind):
                svg, png = self.path("x.svg"), self.path("x.png")
                output = self.succeed(
                    "plot", "diffuse", "reflectance=0.3", "--kind", kind, "-o", svg, "-o", png
                )
                self.assertEqual(output, "")
                root = ElementTree.fromstring(svg.read_text())
                self.assertEqual(root.tag, SVG + "svg")
                self.assertIn("diffuse: reflectance=0.3.", texts(svg.read_text()))
                width, height = map(float, root.get("viewBox").split()[2:])
                self.assertEqual(png_size(png), (round(2 * width), round(2 * height)))
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["x.png", "x.svg"])

    def test_polar_is_the_default_and_goes_to_the_standard_output(self):
        svg = self.succeed("plot", "phong", "exponent=20", "-o", "-")
        self.assertEqual(svg, self.succeed("plot", "phong", "exponent=20", "--kind", "polar", "-o", "-"))
        self.assertIn("Scattering lobes", texts(svg))

    def test_several_materials_have_a_legend(self):
        found = texts(
            self.succeed(
                *"plot diffuse + phong exponent=20 + phong exponent=50 --kind albedo -o -".split()
            )
        )
        for name in ["A diffuse", "B phong", "C phong"]:
            self.assertIn(name, found)
        self.assertIn("C phong: exponent=50.", found)

    def test_angles_and_channels(self):
        svg = self.succeed(*"plot diffuse --theta 10,70 --phi 45 --log -o -".split())
        self.assertIn("viewer at 10°", texts(svg))
        self.assertIn("70°", texts(svg))
        found = texts(self.succeed(*"plot conductor material=Au --kind albedo --channel all -o -".split()))
        for name in ["red", "green", "blue"]:
            self.assertIn(name, found)
        red, blue = (
            self.succeed("plot", "diffuse", "reflectance=0.8,0.3,0.05", "--channel", c, "-o", "-")
            for c in "rb"
        )
        self.assertNotEqual(red, blue)

    def test_weights_of_glass(self):
        # Fresnel at the normal, index 1.5: 4 % come back.
        settings = ["int_ior=1.5", "ext_ior=1"]
        svg = self.succeed("plot", "dielectric", *settings, "--theta", "0", "-o", "-")
        self.assertIn("0.04 reflected, 0.96 transmitted", " ".join(texts(svg)))

    def test_sizes(self):
        png, svg = self.path("x.png"), self.path("x.svg")
        self.succeed(*"plot diffuse --size 600x500 --width 300".split(), "-o", png, "-o", svg)
        self.assertEqual(png_size(png), (300, 250))
        root = ElementTree.fromstring(svg.read_text())
        self.assertEqual(root.get("viewBox"), "0 0 600 500")
        self.assertEqual((root.get("width"), root.get("height")), ("300", "250"))

    def test_themes(self):
        self.assertIn("prefers-color-scheme:dark", self.succeed("plot", "diffuse", "-o", "-"))
        dark = self.succeed("plot", "diffuse", "--theme", "dark", "-o", "-")
        self.assertNotIn("prefers-color-scheme", dark)
        self.assertNotIn('"#ffffff"', dark)

    def test_same_bytes_every_time(self):
        arguments = ["plot", "roughplastic", "--kind", "density", "--samples", "10000", "-o", "-"]
        self.assertEqual(self.succeed(*arguments), self.succeed(*arguments))

    def test_wrong_usage(self):
        for pattern, *arguments in [
            ("give a material", "-o", "x.svg"),
            ("-o FILE", "diffuse"),
            ("a \\+ stands between", "diffuse", "+", "-o", "x.svg"),
            ("a \\+ stands between", "+", "diffuse", "-o", "x.svg"),
            ("stands where the name", "alpha=1", "-o", "x.svg"),
            ("a \\+ stands between", "diffuse", "phong", "-o", "x.svg"),
            ("--kind", "diffuse", "--kind", "polr", "-o", "x.svg"),
            ("--theta means nothing to the kind albedo; it takes --phi", "diffuse", "--kind", "albedo")
            + ("--theta", "3", "-o", "x.svg"),
            ("takes none", "diffuse", "--kind", "reciprocity", "--linear", "-o", "x.svg"),
            ("excludes", "diffuse", "--log", "--linear", "-o", "x.svg"),
            ("finite", "diffuse", "--theta", "nan", "-o", "x.svg"),
            ("WxH", "diffuse", "--size", "10", "-o", "x.svg"),
            ("--channel", "diffuse", "--channel", "x", "-o", "x.svg"),
        ]:
            with self.subTest(arguments):
                self.fail_with(USAGE, pattern, "plot", *arguments)

    def test_bad_input(self):
        for pattern, *arguments in [
            ("did you mean 'diffuse'", "difuse"),
            ("did you mean 'alpha'", "roughconductor", "alhpa=1"),
            ("no plot", "twosided"),
            ("0 to less than 90", "diffuse", "--theta", "120"),
            ("above the surface only", "diffuse", "--kind", "albedo", "--inside"),
            ("300 to 4000", "diffuse", "--size", "20x20"),
            ("at least", "diffuse", "--size", "480x60"),
            ("at most 7", *(["diffuse"] + 7 * ["+", "diffuse"])),
        ]:
            with self.subTest(arguments):
                target = self.path("x.svg")
                self.fail_with(INPUT_ERROR, pattern, "plot", *arguments, "-o", target)
                self.assertFalse(target.exists())
        self.fail_with(INPUT_ERROR, "known: .svg, .png", "plot", "diffuse", "-o", "x.jpg")
        self.fail_with(INPUT_ERROR, "cannot write", "plot", "diffuse", "-o", self.path("no/x.svg"))
        self.assertEqual(run("plot", "--help").returncode, OK)


if __name__ == "__main__":
    main()
