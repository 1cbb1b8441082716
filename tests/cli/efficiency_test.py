"""faceta efficiency: figures known from mathematics, the table, and bad arguments."""

import json

from program import INPUT_ERROR, USAGE, Case, main


class Efficiency(Case):
    def points(self, *arguments):
        text = self.succeed("efficiency", *arguments, "--json", "-")
        return json.loads(text)["subjects"]

    def test_lambert_is_sampled_perfectly(self):
        (subject,) = self.points("diffuse", "reflectance=0.8,0.3,0.05")
        self.assertEqual(subject["model"], "diffuse")
        self.assertEqual(subject["parameters"], {"reflectance": "0.8,0.3,0.05"})
        self.assertEqual([round(p["theta"]) for p in subject["points"]], [0, 30, 60, 80, 89])
        for p in subject["points"]:
            self.assertAlmostEqual(p["variation"], 0, delta=1e-3)
            self.assertAlmostEqual(p["mean"][0], 0.8, delta=1e-5)

    def test_best_and_rule_bound_the_variation(self):
        for subject in self.points("--samples", "4096"):
            for p in subject["points"]:
                if p["variation"] is None:
                    continue
                self.assertLessEqual(p["best"], p["of_rule"] + 1e-9)
                self.assertLessEqual(p["of_rule"], p["variation"] + 0.05, subject["name"])

    def test_tables(self):
        text = self.succeed("efficiency", "diffuse", "dielectric")
        self.assertIn("diffuse/grey", text)
        self.assertIn("from inside", text)
        self.assertEqual(max(map(len, text.splitlines())) <= 100, True)
        text = self.succeed("efficiency", "roughconductor", "alpha=0.3")
        for word in ["variation", "best", "of rule", "failed", "mean weight"]:
            self.assertIn(word, text)

    def test_file_and_seed(self):
        path = self.path("e.json")
        self.succeed("efficiency", "phong", "exponent=3", "--seed", "5", "--json", path)
        once = path.read_text()
        self.succeed("efficiency", "phong", "exponent=3", "--seed", "5", "--json", path)
        self.assertEqual(path.read_text(), once)
        self.succeed("efficiency", "phong", "exponent=3", "--seed", "6", "--json", path)
        self.assertNotEqual(path.read_text(), once)

    def test_bad_arguments(self):
        self.fail_with(INPUT_ERROR, "roughconductor", "efficiency", "roughconducter")
        self.fail_with(INPUT_ERROR, "no single model", "efficiency", "scene.xml")
        self.fail_with(INPUT_ERROR, "no single model", "efficiency", "twosided")
        self.fail_with(INPUT_ERROR, "alpha", "efficiency", "roughconductor", "alpha=-1")
        self.fail_with(USAGE, "samples", "efficiency", "diffuse", "--samples", "1")
        self.fail_with(USAGE, "no material", "efficiency", "alpha=1")


if __name__ == "__main__":
    main()
