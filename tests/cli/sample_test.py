"""faceta sample: against Lambert's law, mirrors and glass, and against eval."""

import json
import math
import random

import program
from program import Case, main, read_table, to_float32
from eval_test import direction, is_shortest

HEADER = "wo_x,wo_y,wo_z,u1,u2,uc"
RESULTS = "wi_x,wi_y,wi_z,weight_r,weight_g,weight_b,pdf,lobe,delta"
NUMBERS = RESULTS.split(",")[:7]


def table(count, seed=1):
    generator = random.Random(seed)
    rows = [
        ",".join(direction(generator) + [repr(generator.random()) for _ in range(3)])
        for _ in range(count)
    ]
    return "\n".join([HEADER] + rows) + "\n"


class Sample(Case):
    def test_lambert(self):
        text = self.succeed("sample", "diffuse", "reflectance=0.8,0.3,0.05", stdin=table(999))
        self.assertEqual(text.splitlines()[0], HEADER + "," + RESULTS)
        rows = read_table(text)
        self.assertEqual(len(rows), 999)
        valid = 0
        cosines = 0
        for row in rows:
            if float(row["wo_z"]) <= 0:
                self.assertEqual([row[n] for n in RESULTS.split(",")], ["0"] * 7 + ["none", "0"])
                continue
            valid += 1
            x, y, z = (float(row[n]) for n in NUMBERS[:3])
            cosines += z
            self.assertGreater(z, 0)
            self.assertAlmostEqual(x * x + y * y + z * z, 1, delta=1e-6)
            for name, albedo in zip(NUMBERS[3:6], [0.8, 0.3, 0.05]):
                self.assertAlmostEqual(float(row[name]), albedo, delta=1e-6)
            self.assertAlmostEqual(float(row["pdf"]), z / math.pi, delta=1e-6)
            self.assertEqual((row["lobe"], row["delta"]), ("reflection", "0"))
            for name in NUMBERS:
                self.assertTrue(is_shortest(row[name]), row[name])
        self.assertGreater(valid, 400)
        # Cosine-distributed: E[z] = 2/3 with variance 1/2 - 4/9; six standard errors.
        self.assertAlmostEqual(cosines / valid, 2 / 3, delta=6 * math.sqrt(1 / 18 / valid))

    def test_weight_is_value_over_pdf_of_eval(self):
        for material in ["diffuse", "orennayar"]:
            rows = read_table(self.succeed("sample", material, stdin=table(400)))
            rows = [row for row in rows if row["lobe"] != "none"]
            self.assertGreater(len(rows), 150)
            names = ["wo_x", "wo_y", "wo_z", "wi_x", "wi_y", "wi_z"]
            lines = [",".join(row[n] for n in names) for row in rows]
            values = read_table(
                self.succeed("eval", material, stdin="\n".join([",".join(names)] + lines) + "\n")
            )
            for row, value in zip(rows, values, strict=True):
                self.assertAlmostEqual(float(row["pdf"]), float(value["pdf"]), delta=1e-6)
                for c in "rgb":
                    self.assertAlmostEqual(
                        float(row["weight_" + c]) * float(row["pdf"]),
                        float(value["value_" + c]),
                        delta=1e-6,
                    )

    def test_mirror(self):
        # A perfect mirror: material none, delta of probability 1, weight 1.
        if not program.has_material("conductor"):
            self.skipTest("conductor is not registered")
        for row in read_table(self.succeed("sample", "conductor", "material=none", stdin=table(99))):
            if float(row["wo_z"]) <= 0:
                self.assertEqual(row["lobe"], "none")
                continue
            for name, sign in [("x", -1), ("y", -1), ("z", 1)]:
                self.assertEqual(to_float32(row["wi_" + name]), sign * to_float32(row["wo_" + name]))
            self.assertEqual((row["pdf"], row["lobe"], row["delta"]), ("1", "reflection", "1"))
            self.assertAlmostEqual(float(row["weight_g"]), 1, delta=1e-6)

    def test_glass(self):
        # Fresnel at normal incidence: R = ((n - 1) / (n + 1))^2 = 0.04 for n = 1.5.
        if not program.has_material("dielectric"):
            self.skipTest("dielectric is not registered")
        text = f"{HEADER}\n0,0,1,0.5,0.5,0.01\n0,0,1,0.5,0.5,0.9\n"
        glass = ["dielectric", "int_ior=1.5", "ext_ior=1"]
        for mode, transmitted in [("radiance", 1 / 2.25), ("importance", 1)]:
            lobes = {
                row["lobe"]: row
                for row in read_table(self.succeed("sample", *glass, "--mode", mode, stdin=text))
            }
            self.assertEqual(set(lobes), {"reflection", "transmission"})
            for lobe, z, pdf, weight in [
                ("reflection", 1, 0.04, 1),
                ("transmission", -1, 0.96, transmitted),
            ]:
                row = lobes[lobe]
                self.assertEqual((float(row["wi_z"]), row["delta"]), (z, "1"))
                self.assertAlmostEqual(float(row["pdf"]), pdf, delta=1e-6)
                self.assertAlmostEqual(float(row["weight_r"]), weight, delta=1e-6)

    def test_same_bits_from_every_instruction_set(self):
        best = self.succeed("sample", "orennayar", stdin=table(333))
        for name in json.loads(self.succeed("info", "--cpu", "--json"))["instruction_sets"]:
            self.assertEqual(
                self.succeed("sample", "orennayar", "--isa", name, stdin=table(333)), best
            )

    def test_numbers_that_round_to_one(self):
        text = f"{HEADER}\n0,0,1,0.99999999999,1,1\n0,0,1,0.99999994,0.99999994,0.99999994\n"
        rows = read_table(self.succeed("sample", "diffuse", stdin=text))
        self.assertEqual([rows[0][n] for n in NUMBERS], [rows[1][n] for n in NUMBERS])

    def test_a_million_rows(self):
        source, target = self.path("in.csv"), self.path("out.csv")
        lines = table(1000).splitlines(keepends=True)
        source.write_text(lines[0] + "".join(lines[1:]) * 1000)
        self.succeed("sample", "diffuse", "-i", source, "-o", target)
        once = self.succeed("sample", "diffuse", stdin="".join(lines)).splitlines(keepends=True)
        self.assertTrue(target.read_text() == once[0] + "".join(once[1:]) * 1000)


if __name__ == "__main__":
    main()
