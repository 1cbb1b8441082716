"""faceta eval: values against Lambert's law, tables, modes, instruction sets."""

import json
import math
import os
import random
import subprocess

import program
from program import Case, main, read_table, to_float32

HEADER = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z"
RESULTS = ["value_r", "value_g", "value_b", "pdf"]


def direction(generator):
    """A direction of either side, uniform, with shortest decimals of its floats."""
    z, phi = generator.uniform(-1, 1), generator.uniform(0, 2 * math.pi)
    r = math.sqrt(1 - z * z)
    return [repr(to_float32(v)) for v in (r * math.cos(phi), r * math.sin(phi), z)]


def table(count, seed=1):
    generator = random.Random(seed)
    rows = [",".join(direction(generator) + direction(generator)) for _ in range(count)]
    return "\n".join([HEADER] + rows) + "\n"


def is_shortest(text):
    """No decimal with fewer digits reads back the same float."""
    value = to_float32(text)
    shortest = next(k for k in range(1, 10) if to_float32(f"{value:.{k}g}") == value)
    digits = text.lower().split("e")[0].replace("-", "").replace(".", "").strip("0")
    return len(digits) <= shortest


class Eval(Case):
    def test_lambert(self):
        albedo = [0.8, 0.3, 0.05]
        rows = read_table(self.succeed("eval", "diffuse", "reflectance=0.8,0.3,0.05", stdin=table(999)))
        self.assertEqual(len(rows), 999)
        lit = 0
        for row in rows:
            above = float(row["wo_z"]) > 0 and float(row["wi_z"]) > 0
            pdf = float(row["wi_z"]) / math.pi if above else 0
            lit += above
            for name, wanted in zip(RESULTS, [a * pdf for a in albedo] + [pdf]):
                self.assertAlmostEqual(float(row[name]), wanted, delta=2e-7)
        self.assertGreater(lit, 150)

    def test_input_stands_unchanged_before_the_results(self):
        source = table(50)
        lines = self.succeed("eval", "diffuse", stdin=source).splitlines()
        self.assertEqual(lines[0], HEADER + "," + ",".join(RESULTS))
        for before, after in zip(source.splitlines(), lines, strict=True):
            self.assertTrue(after.startswith(before + ","))
            self.assertEqual(after.count(","), before.count(",") + 4)

    def test_shortest_decimals(self):
        for row in read_table(self.succeed("eval", "diffuse", stdin=table(500))):
            for name in RESULTS:
                self.assertTrue(is_shortest(row[name]), row[name])

    def test_columns_in_any_order_and_others_kept(self):
        text = 'name,wi_z,wi_y,wi_x,wo_z,wo_x,wo_y,v,u\n"a, ""b""",0.8,0,0.6,1,0,0,0.25,0.5\n'
        lines = self.succeed("eval", "diffuse", stdin=text).splitlines()
        self.assertEqual(lines[0], text.splitlines()[0] + "," + ",".join(RESULTS))
        self.assertTrue(lines[1].startswith(text.splitlines()[1] + ","))
        self.assertAlmostEqual(float(lines[1].split(",")[-1]), 0.8 / math.pi, delta=1e-7)

    def test_ways_to_write_a_table(self):
        wanted = self.succeed("eval", "diffuse", stdin=f"{HEADER}\n0,0,1,0.6,0,0.8\n").splitlines()[1]
        wanted = wanted.split(",")[6:]
        for text in [
            f"{HEADER}\r\n0,0,1,0.6,0,0.8\r\n",
            f"{HEADER}\n0,0,1,0.6,0,0.8",
            f"{HEADER}\n\n  \n0,0,1,0.6,0,0.8\n\n",
            f"\ufeff{HEADER}\n0,0,1,0.6,0,0.8\n",
            f" {HEADER.replace(',', ' , ')} \n 0 ,\t0, 1,0.6 , 0,0.8 \n",
            f"{HEADER}\n\"0\",\"0\",\"1\",\"0.6\",\"0\",\"0.8\"\n",
            f"{HEADER}\n+0,-0,+1.0e0,6e-1,1e-400,.8\n",
            f"{HEADER}\n0,0,1.,0.59999999999999999,-1e-46,0.{'8' + '0' * 500}\n",
        ]:
            with self.subTest(text):
                rows = self.succeed("eval", "diffuse", stdin=text).splitlines()
                self.assertEqual(len(rows), 2)
                self.assertEqual(rows[1].split(",")[6:], wanted)

    def test_files_and_streams_agree(self):
        source, target = self.path("in.csv", table(300)), self.path("out.csv")
        self.assertEqual(self.succeed("eval", "diffuse", "--input", source, "--output", target), "")
        piped = self.succeed("eval", "diffuse", "--input", "-", "--output", "-", stdin=table(300))
        self.assertEqual(target.read_text(), piped)
        # In place: the source is read before the target gets its name.
        self.succeed("eval", "diffuse", "-i", source, "-o", source)
        self.assertEqual(source.read_text(), piped)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["in.csv", "out.csv"])

    def test_header_alone(self):
        self.assertEqual(
            self.succeed("eval", "diffuse", stdin=HEADER + "\n"),
            HEADER + "," + ",".join(RESULTS) + "\n",
        )

    def test_writes_into_a_pipe(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        with subprocess.Popen(["cat", pipe], stdout=subprocess.PIPE, text=True) as reader:
            try:
                self.succeed("eval", "diffuse", "-o", pipe, stdin=table(10))
                self.assertEqual(reader.communicate(timeout=60)[0].count("\n"), 11)
            finally:
                reader.kill()

    def test_same_bits_from_every_instruction_set(self):
        sets = json.loads(self.succeed("info", "--cpu", "--json"))["instruction_sets"]
        self.assertIn("scalar", sets)
        best = self.succeed("eval", "diffuse", stdin=table(333))
        for name in sets:
            self.assertEqual(self.succeed("eval", "diffuse", "--isa", name, stdin=table(333)), best)

    def test_importance_differs_by_the_square_of_eta(self):
        # Across a rough interface radiance is scaled by 1/eta^2, importance is not.
        if not program.has_material("roughdielectric"):
            self.skipTest("roughdielectric is not registered")
        text = f"{HEADER}\n0,0,1,0,0,-1\n0.6,0,0.8,-0.4,0,-0.916515139\n"
        settings = ["roughdielectric", "int_ior=1.5", "ext_ior=1", "alpha=0.3"]
        radiance = read_table(self.succeed("eval", *settings, stdin=text))
        importance = read_table(self.succeed("eval", *settings, "--mode", "importance", stdin=text))
        for r, i in zip(radiance, importance):
            self.assertGreater(float(r["value_r"]), 0)
            self.assertAlmostEqual(float(i["value_r"]) / float(r["value_r"]), 2.25, delta=1e-5)

    def test_a_million_rows_in_order(self):
        generator = random.Random(3)
        block = [",".join(direction(generator) + direction(generator)) for _ in range(1000)]
        single = self.succeed(
            "eval", "orennayar", stdin=HEADER + "\n" + "\n".join(block) + "\n"
        ).splitlines()[1:]
        results = [line.split(",", 6)[6] for line in single]
        source, target = self.path("in.csv"), self.path("out.csv")
        with open(source, "w") as file:
            file.write(HEADER + ",row\n")
            for k in range(1000):
                file.writelines(f"{line},{1000 * k + i}\n" for i, line in enumerate(block))
        self.succeed("eval", "orennayar", "-i", source, "-o", target)
        with open(target) as file:
            next(file)
            count = 0
            for count, line in enumerate(file, 1):
                i = (count - 1) % 1000
                if line != f"{block[i]},{count - 1},{results[i]}\n":
                    self.fail(f"row {count}: {line}")
        self.assertEqual(count, 1000000)


if __name__ == "__main__":
    main()
