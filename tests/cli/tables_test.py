"""Malformed tables: one message with file, line and column, exit code 3, no partial file."""

import subprocess

import program
from program import INPUT_ERROR, Case, main

EVAL = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z"
SAMPLE = "wo_x,wo_y,wo_z,u1,u2,uc"
GOOD = "0,0,1,0.6,0,0.8\n"


class Tables(Case):
    def test_malformed_tables(self):
        for command, text, place, message in [
            ("eval", "", "", "the table is empty"),
            ("eval", "\n", "1:1", "no column 'wo_x'"),
            ("eval", GOOD, "1:1", "no column 'wo_x'"),
            ("eval", "wo_x,wo_y,wo_z,wi_x,wi_y\n", "1:1", "no column 'wi_z'"),
            ("eval", EVAL + ",wo_y\n", "1:31", "column 'wo_y' is there twice"),
            ("eval", EVAL + ", pdf\n", "1:32", "column 'pdf' is there already"),
            ("sample", SAMPLE + ",wi_x\n", "1:25", "column 'wi_x' is there already"),
            ("eval", f"{EVAL}\n{GOOD}0,0,1,0.6,0\n", "3:12", "has 5 fields, its header 6"),
            ("eval", f"{EVAL}\n{GOOD}\n0,0,1,0.6,0,0.8,1\n", "4:17", "more fields"),
            ("eval", f"{EVAL}\n0,0,one,0.6,0,0.8\n", "2:5", "column 'wo_z': 'one' is no finite"),
            ("eval", f"{EVAL}\n0,0,1, nan,0,0.8\n", "2:8", "column 'wi_x': 'nan' is no finite"),
            ("eval", f"{EVAL}\n0,0,1,inf,0,0.8\n", "2:7", "no finite number"),
            ("eval", f"{EVAL}\n0,0,1,1e39,0,0.8\n", "2:7", "no finite number"),
            ("eval", f"{EVAL}\n0,0,1,1e999,0,0.8\n", "2:7", "no finite number"),
            ("eval", f"{EVAL}\n0,0,1,0x1,0,0.8\n", "2:7", "no finite number"),
            ("eval", f"{EVAL}\n0,0,1,+-1,0,0.8\n", "2:7", "no finite number"),
            ("eval", f"{EVAL}\n0,0,1,0.6 0,0,0.8\n", "2:7", "no finite number"),
            ("eval", f"{EVAL}\n0,0,1,,0,0.8\n", "2:7", "an empty field"),
            ("eval", f'{EVAL}\n0,0,1,"0.6,0,0.8\n', "2:7", "quoted field has no end"),
            ("eval", f'{EVAL}\n0,0,1,"0.6"1,0,0.8\n', "2:12", "text after a quoted field"),
            ("eval", f"{EVAL}\n{GOOD}0,0,1,0.6,0,0.9\n", "3:7", r"wi has the length 1\.08"),
            ("eval", f"{EVAL}\n0,0,0,0.6,0,0.8\n", "2:1", "wo has the length 0 "),
            ("eval", f"{EVAL}\n0,0,1.0011,0.6,0,0.8\n", "2:1", r"wo has the length 1\.0011"),
            ("sample", f"{SAMPLE}\n0,0,1,0.5,-0.1,0.5\n", "2:11", r"u2 is -0\.1"),
            ("sample", f"{SAMPLE}\n0,0,1,0.5,0.1,1.5\n", "2:15", r"uc is 1\.5"),
            ("sample", f"{SAMPLE}\n0,0,2,0.5,0.1,0.5\n", "2:1", "wo has the length 2"),
            # The first mistake counts, whatever its kind.
            ("eval", f"{EVAL}\n0,0,2,0.6,0,0.8\n0,0,x,0.6,0,0.8\n", "2:1", "length 2"),
            ("eval", f"{EVAL}\n0,0,x,0.6,0,0.8\n0,0,2,0.6,0,0.8\n", "2:5", "'x'"),
            ("eval", "\0\1\2,\xff\n" * 3, "1:1", "no column"),
            ("eval", "a" * 3000000, "1:1", "longer than 1 MiB"),
            ("eval", EVAL + "\n" + "1" * 3000000, "2:1", "longer than 1 MiB"),
        ]:
            with self.subTest(text[:80]):
                source, target = self.path("in.csv", text), self.path("out.csv")
                where = f":{place}" if place else ""
                stderr = self.fail_with(
                    INPUT_ERROR, rf"^{source}{where}: error: .*{message}", command, "diffuse",
                    "-i", source, "-o", target,
                )
                self.assertEqual(stderr.count("\n"), 1)
                self.assertEqual([p.name for p in self.folder.iterdir()], ["in.csv"])

    def test_lengths_near_one_are_taken_as_they_are(self):
        text = f"{EVAL}\n0,0,1.0009,0.6,0,0.8\n"
        self.assertIn("0,0,1.0009,", self.succeed("eval", "diffuse", stdin=text))

    def test_standard_input_has_a_name(self):
        self.fail_with(INPUT_ERROR, r"^<stdin>:1:1: error: ", "eval", "diffuse", stdin="x\n")

    def test_late_mistake_leaves_the_old_file(self):
        count = 40000
        source = self.path("in.csv", f"{EVAL}\n{GOOD * count}0,0,1,0.6,0,oops\n{GOOD * count}")
        target = self.path("out.csv", "old\n")
        self.fail_with(
            INPUT_ERROR, rf"in\.csv:{count + 2}:13: error: column 'wi_z': 'oops'", "eval",
            "diffuse", "-i", source, "-o", target,
        )
        self.assertEqual(target.read_text(), "old\n")
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["in.csv", "out.csv"])

    def test_the_first_of_several_mistakes_counts(self):
        rows = [GOOD] * 30000
        for at in (29000, 12345, 25000):
            rows[at] = "0,0,2,0.6,0,0.8\n"
        source = self.path("in.csv", EVAL + "\n" + "".join(rows))
        for _ in range(5):
            self.fail_with(
                INPUT_ERROR, r"in\.csv:12347:1: error: wo", "eval", "diffuse", "-i", source, "-o",
                self.path("out.csv"),
            )

    def test_places_that_cannot_be_read_or_written(self):
        for arguments in [
            ["-i", self.folder],
            ["-i", self.folder / "none.csv"],
            ["-o", self.folder],
            ["-o", self.folder / "none" / "out.csv"],
            ["-o", "/dev/full"],
        ]:
            with self.subTest(arguments):
                self.fail_with(
                    INPUT_ERROR, r"^\S+: error: cannot (read|write)", "eval", "diffuse",
                    *arguments, stdin=f"{EVAL}\n{GOOD}",
                )

    def test_full_standard_output(self):
        for arguments in [["materials"], ["info", "--cpu"], ["eval", "diffuse"]]:
            with open("/dev/full", "w") as full:
                process = subprocess.run(
                    [program.PROGRAM, *arguments], input=f"{EVAL}\n{GOOD}", stdout=full,
                    stderr=subprocess.PIPE, text=True, timeout=60,
                )
            self.assertEqual(process.returncode, INPUT_ERROR)
            self.assertRegex(process.stderr, r"^<stdout>: error: cannot write: ")


if __name__ == "__main__":
    main()
