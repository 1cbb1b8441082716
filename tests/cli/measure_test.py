"""faceta measure: info, repair and convert, over materials whose figures are known."""

import json
import math
import struct

from program import INPUT_ERROR, USAGE, Case, main, read_table


class Measure(Case):
    def convert(self, *arguments):
        return json.loads(self.succeed("measure", "convert", *arguments, "--json"))

    def test_lambert_through_every_format(self):
        for name, form in [("a.bsdf", "rgl"), ("a.binary", "merl")]:
            path = self.path(name)
            made = self.convert("diffuse", "reflectance=0.8,0.3,0.05", path)
            self.assertLess(made["error"], 0.005)
            info = json.loads(self.succeed("measure", "info", path, "--json"))
            self.assertEqual(info["format"], form)
            self.assertTrue(info["audit"]["clean"], info["audit"]["findings"])
            for angle in info["audit"]["angles"][:3]:
                for got, wanted in zip(angle["albedo"], (0.8, 0.3, 0.05)):
                    self.assertAlmostEqual(got, wanted, delta=0.005)

    def test_the_table_holds_values_without_the_cosine(self):
        path = self.path("a.csv")
        self.convert("diffuse", "reflectance=0.6", path, "--resolution", "15")
        rows = read_table(path.read_text())
        self.assertEqual(list(rows[0]), ["theta_i", "phi_i", "theta_o", "phi_o", "r", "g", "b"])
        self.assertEqual(len(rows), 7 * 7 * 24)
        for row in rows:
            self.assertAlmostEqual(float(row["g"]), 0.6 / math.pi, delta=1e-6)

    def test_a_file_again(self):
        first, second = self.path("a.bsdf"), self.path("b.file")
        self.convert("roughconductor", "material=Au", "alpha=0.3", first)
        made = self.convert(first, "scale=0.5", second, "--to", "rgl")
        self.assertLess(made["error"], 0.01)
        albedos = json.loads(self.succeed("measure", "info", first, second, "--json"))
        for a, b in zip(*(x["audit"]["angles"][:3] for x in albedos)):
            self.assertAlmostEqual(0.5 * a["albedo"][0], b["albedo"][0], delta=0.005)

    def test_repair(self):
        # A MERL file of Lambert's law with a hole and more light than there is.
        cells = 90 * 90 * 180
        plane = [1.2 / math.pi] * cells
        plane[cells // 2] = -1
        path, mended = self.path("bright.binary"), self.path("mended.binary")
        with open(path, "wb") as file:
            file.write(struct.pack("3i", 90, 90, 180))
            for scale in (1, 1.15, 1.66):
                file.write(struct.pack(f"{cells}d", *(v * 1500 / scale for v in plane)))
        before = json.loads(self.succeed("measure", "info", path, "--json"))["audit"]
        self.assertEqual((before["holes"], before["clean"]), (1, False))
        self.assertAlmostEqual(before["angles"][0]["largest"], 1.2, delta=0.005)
        notes = self.succeed("measure", "info", path, "--repair", mended)
        self.assertIn("1 holes filled", notes)
        after = json.loads(self.succeed("measure", "info", mended, "--json"))["audit"]
        self.assertTrue(after["clean"], after["findings"])
        self.assertAlmostEqual(after["angles"][0]["largest"], 0.99, delta=0.01)

    def test_text(self):
        text = self.succeed("measure", "info", "demo:plastic")
        for word in ["demo:plastic", "albedo", "reciprocal", "degrees"]:
            self.assertIn(word, text)

    def test_bad_arguments(self):
        out = self.path("a.bsdf")
        self.fail_with(USAGE, "--to", "measure", "convert", "diffuse", self.path("a.foo"))
        self.fail_with(USAGE, "first", "measure", "convert", "diffuse")
        self.fail_with(USAGE, "one file", "measure", "info", "demo:plastic", "demo:metal",
                       "--repair", out)
        self.fail_with(USAGE, "--repair", "measure", "info", "demo:plastic", "--max-theta", "70")
        self.fail_with(INPUT_ERROR, "roughconductor", "measure", "convert", "roughconducter", out)
        self.fail_with(INPUT_ERROR, "single directions", "measure", "convert", "conductor", out)
        self.fail_with(INPUT_ERROR, "not isotropic", "measure", "convert", "roughconductor",
                       "alpha_u=0.1", "alpha_v=0.4", self.path("a.binary"))
        self.fail_with(INPUT_ERROR, "alpha", "measure", "convert", "roughconductor", "alpha=-1", out)
        self.fail_with(INPUT_ERROR, "how a file is read", "measure", "info", "demo:plastic",
                       "scale=2")
        broken = self.path("broken.bsdf", "tensor_file\0nonsense")
        self.fail_with(INPUT_ERROR, "broken.bsdf", "measure", "info", broken)
        self.assertFalse(out.exists())


if __name__ == "__main__":
    main()
