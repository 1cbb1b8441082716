"""faceta verify: targets, tables, JSON, exit codes. Few materials and properties: it must be fast."""

import json
import os
import pty
import subprocess

import program
from program import INPUT_ERROR, OK, USAGE, Case, main, materials, run

QUICK = ["--only", "finite", "reciprocity", "round_trip"]
FIELDS = ["version", "passed", "effort", "seed", "isa", "family_level", "test_level", "seconds"]
FIELDS += ["counts", "properties", "models", "subjects", "notes"]

SCENE = """<scene version="3.0.0">
  <bsdf type="twosided" id="floor">
    <bsdf type="diffuse">
      <texture type="checkerboard" name="reflectance">
        <rgb name="color0" value="0.2"/><rgb name="color1" value="0.6"/>
      </texture>
    </bsdf>
  </bsdf>
  <bsdf type="roughconductor" id="pan"><float name="alpha" value="$alpha"/></bsdf>
  <bsdf type="phong" id="chalk"/>
  <shape type="sphere"><bsdf type="phong"/></shape>
</scene>
"""


class Verify(Case):
    def verify(self, *arguments):
        return self.succeed("verify", "-q", *arguments)

    def json_of(self, *arguments):
        return json.loads(self.verify(*arguments, "--json", "-"))

    def test_list_names_each_property_with_its_claim(self):
        lines = self.succeed("verify", "--list").splitlines()
        names = [line.split()[0] for line in lines]
        for name in ["finite", "chi2", "energy", "reciprocity", "parameters"]:
            self.assertIn(name, names)
        for line in lines:
            self.assertGreater(len(line.split()), 3)

    def test_everything_is_every_exemplar_of_every_model(self):
        report = self.json_of("--only", "round_trip,description")
        self.assertEqual(list(report), FIELDS)
        wanted = {f"{m['name']}/{e['name']}" for m in materials(None) for e in m["exemplars"]}
        self.assertEqual({s["name"] for s in report["subjects"]}, wanted)
        self.assertEqual({m["name"] for m in report["models"]}, {m["name"] for m in materials()})
        self.assertTrue(report["passed"])
        checks = len(report["subjects"]) + len(report["models"])
        self.assertEqual(report["counts"]["passed"], checks)

    def test_all_properties_of_one_material(self):
        report = self.json_of("diffuse", "reflectance=0.7")
        listed = [line.split()[0] for line in self.succeed("verify", "--list").splitlines()]
        own = [p["name"] for p in report["properties"] if p["of"] == "subject"]
        self.assertEqual([p["name"] for p in report["properties"]], listed)
        self.assertEqual(report["models"], [])
        (subject,) = report["subjects"]
        self.assertEqual(subject["name"], "diffuse reflectance=0.7")
        self.assertEqual(subject["origin"], "settings")
        self.assertEqual(subject["parameters"], {"reflectance": "0.7,0.7,0.7"})
        results = {r["property"]: r for r in subject["results"]}
        self.assertEqual(list(results), own)
        self.assertEqual({r["verdict"] for r in subject["results"]}, {"passed"})
        # Lambert's albedo is the reflectance.
        self.assertAlmostEqual(results["energy"]["figure"], 0.7, places=5)
        self.assertLess(report["test_level"] * 106, report["family_level"] * 1.001)
        self.assertGreater(results["chi2"]["figure"], report["test_level"])

    def test_table(self):
        text = self.verify("diffuse", "phong", *QUICK)
        for words in ["finite", "reciprocity", "diffuse/white", "phong/sharp", " ok ", "0 failed"]:
            self.assertIn(words, text)
        self.assertNotIn("\x1b", text)
        self.assertLessEqual(max(map(len, text.splitlines())), 100)
        self.assertEqual(sum(line.startswith("phong/") for line in text.splitlines()), 6)

    def test_settings_belong_to_the_material_before_them(self):
        report = self.json_of("phong", "exponent=9", "diffuse", "phong", "exponent=3", *QUICK)
        names = [s["name"] for s in report["subjects"]]
        self.assertEqual(names[0], "phong exponent=9")
        self.assertEqual(names[-1], "phong exponent=3")
        self.assertEqual({n.split("/")[0] for n in names[1:-1]}, {"diffuse"})

    def test_an_excuse_is_told_with_its_reason(self):
        settings = ["orennayar", "sigma=0.3", "reflectance=1", "--only", "energy"]
        (result,) = self.json_of(*settings)["subjects"][0]["results"]
        self.assertEqual(result["verdict"], "excused")
        self.assertGreater(result["figure"], 1.03)
        self.assertIn("1994 model", result["reason"])
        text = self.verify(*settings)
        self.assertIn("1 excused", text)
        self.assertIn("1994 model", text)

    def test_failure(self):
        # A number above 1 in a scene is taken, as in Mitsuba, but it gives back more than it gets.
        scene = self.path(
            "bright.xml",
            '<bsdf version="3.0.0" type="diffuse" id="lamp"><float name="reflectance" value="1.5"/></bsdf>',
        )
        process = run("verify", scene, "-q", "--only", "energy", "round_trip")
        self.assertEqual((process.returncode, process.stderr), (1, ""))
        self.assertIn("FAILED lamp: energy", process.stdout)
        self.assertIn("albedo 1.5", process.stdout)
        report = self.path("report.json")
        process = run("verify", scene, "-q", "--only", "energy", "round_trip", "--json", report)
        self.assertEqual(process.returncode, 1)
        counts = json.loads(report.read_text())["counts"]
        self.assertEqual(counts, {"passed": 0, "failed": 1, "excused": 0, "not_applicable": 1})

    def test_scene(self):
        scene = self.path("scene.xml", SCENE)
        report = self.json_of(scene, "-D", "alpha=0.3", *QUICK)
        subjects = {s["name"]: s for s in report["subjects"]}
        self.assertEqual(list(subjects), ["floor", "floor/diffuse", "pan", "chalk"])
        self.assertEqual(subjects["pan"]["parameters"]["alpha"], "0.3")
        self.assertEqual(subjects["pan"]["where"], f"{scene}:9:3")
        notes = "\n".join(report["notes"])
        self.assertIn("floor/diffuse: reflectance is a texture; verified with its mean", notes)
        self.assertIn("chalk stands for equal parameters: phong:11", notes)
        self.assertEqual(subjects["floor"]["model"], "twosided")
        self.assertRegex(subjects["floor"]["tree"], r"^twosided\(diffuse reflectance=[^)]*\)$")
        self.assertIn("note: chalk stands", self.verify(scene, "-D", "alpha=0.3", *QUICK))

    def test_seed_changes_statistics(self):
        def p_value(*arguments):
            report = self.json_of("diffuse", "reflectance=0.5", "--only", "chi2", *arguments)
            return report["seed"], report["subjects"][0]["results"][0]["figure"]

        self.assertEqual(p_value(), p_value("--seed", "0"))
        self.assertNotEqual(p_value("--seed", "7")[1], p_value()[1])
        self.assertEqual(p_value("--seed", "7")[0], 7)

    def test_progress_in_plain_lines(self):
        process = run("verify", "phong", *QUICK)
        self.assertEqual(process.returncode, OK)
        self.assertRegex(process.stderr, r"(?m)^100 %  18/18 checks, \d+ s$")
        self.assertNotIn("\r", process.stderr)

    def test_colours_and_a_bar_on_a_terminal(self):
        def on_terminal(environment):
            mine, theirs = pty.openpty()
            arguments = [program.PROGRAM, "verify", "diffuse", *QUICK]
            with subprocess.Popen(
                arguments, stdout=theirs, stderr=theirs, env={**os.environ, **environment}
            ) as process:
                os.close(theirs)
                data = b""
                try:
                    while piece := os.read(mine, 65536):
                        data += piece
                except OSError:  # how Linux says that the other end is closed
                    pass
            os.close(mine)
            self.assertEqual(process.returncode, OK)
            return data

        data = on_terminal({})
        self.assertIn(b"\x1b[32mok", data)
        self.assertIn(b"\r[====", data)
        self.assertNotIn(b"\x1b[32m", on_terminal({"NO_COLOR": "1"}))

    def test_usage(self):
        self.fail_with(USAGE, "belongs to|stands behind no material", "verify", "alpha=0.2")
        self.fail_with(USAGE, "behind no material", "verify", "scene.xml", "alpha=0.2")
        self.fail_with(USAGE, "-D needs a scene", "verify", "diffuse", "-D", "a=1")
        self.fail_with(USAGE, "chi3", "verify", "diffuse", "--only", "chi3")
        self.fail_with(USAGE, "effort", "verify", "diffuse", "--effort", "some")
        self.fail_with(USAGE, "seed", "verify", "diffuse", "--seed", "-1")

    def test_bad_input(self):
        self.fail_with(INPUT_ERROR, "did you mean 'phong'", "verify", "-q", "fong")
        self.fail_with(INPUT_ERROR, "exponent", "verify", "-q", "phong", "exponent=-1")
        self.fail_with(INPUT_ERROR, "did you mean 'exponent'", "verify", "-q", "phong", "exponnt=1")
        self.fail_with(INPUT_ERROR, "scene file", "verify", "-q", "mask", "opacity=0.5")
        self.fail_with(INPUT_ERROR, "none.xml", "verify", "-q", self.path("none.xml"))
        self.fail_with(
            INPUT_ERROR, "nothing to verify", "verify", "-q", "phong", "exponent=2", "--only", "parameters"
        )
        empty = self.path("empty.xml", '<scene version="3.0.0"/>')
        self.fail_with(INPUT_ERROR, "empty.xml:1:1: error: .*no bsdf", "verify", "-q", empty)
        text = '<bsdf version="3.0.0" type="diffuse"><float name="alpha" value="1"/></bsdf>'
        wrong = self.path("wrong.xml", text)
        self.fail_with(INPUT_ERROR, "wrong.xml:1:.*alpha", "verify", "-q", wrong)
        target = self.path("no") / "report.json"
        self.fail_with(INPUT_ERROR, "report.json", "verify", "-q", "diffuse", "--json", target)


if __name__ == "__main__":
    main()
