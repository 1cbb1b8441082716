"""faceta fit: from a file whose material is known back to that material."""

import json

from program import INPUT_ERROR, USAGE, Case, main


class Fit(Case):
    def test_a_material_comes_back(self):
        table, xml, report = self.path("a.bsdf"), self.path("a.xml"), self.path("a.json")
        self.succeed("measure", "convert", "roughconductor", "material=Au", "alpha=0.3",
                     "distribution=ggx", table)
        text = self.succeed("fit", table, "--model", "roughconductor", "--lobes", "1",
                            "-o", xml, "-o", report)
        self.assertIn("E_log", text)
        fit = json.loads(report.read_text())
        self.assertLess(fit["errors"]["log"], 0.01)
        self.assertEqual(fit["model"], "roughconductor")
        # What is written is a material again, and near what the file was made of.
        body = xml.read_text()
        self.assertIn("roughconductor", body)
        scene = self.path("s.xml")
        scene.write_text('<scene version="3.0.0">' + body[body.index("<bsdf"):].replace(
            ' version="3.0.0"', ' id="fit"', 1) + "</scene>")
        self.succeed("verify", "-q", scene, "--only", "finite,consistency")

    def test_maps(self):
        folder = self.path("maps")
        self.succeed("fit", "demo:metal", "--model", "ggx", "--lobes", "1", "-q", "--maps", folder)
        self.assertEqual(sorted(p.name for p in folder.iterdir()),
                         ["mean.png", "residuals.csv", "rms.png"])

    def test_errors(self):
        self.fail_with(INPUT_ERROR, "no.file", "fit", "no.file")
        self.fail_with(INPUT_ERROR, "ending", "fit", "demo:metal", "-o", self.path("a.obj"))
        self.fail_with(USAGE, "--lobes", "fit", "demo:metal", "--lobes", "7")
        self.fail_with(USAGE, "--model", "fit", "demo:metal", "--model", "unknown")


if __name__ == "__main__":
    main()
