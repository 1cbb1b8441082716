"""faceta verify --html: the page as a browser reads it."""

import base64
import json
import re
import struct

from page import Page
from program import INPUT_ERROR, OK, USAGE, Case, main, materials, run


class VerifyHtml(Case):
    def page(self, *arguments, code=OK):
        """The page that a run writes, checked for what holds of every page, and its text."""
        file = self.path("report.html")
        process = run("verify", "-q", *arguments, "--html", file)
        self.assertEqual((process.returncode, process.stderr), (code, ""))
        text = file.read_bytes().decode("utf-8")
        self.assertEqual([f.name for f in self.folder.glob("report*")], ["report.html"])
        page = Page(text)
        self.check(page, text)
        return page, text

    def check(self, page, text):
        self.assertEqual(page.errors, [])
        self.assertTrue(text.startswith("<!DOCTYPE html>"))
        self.assertEqual(page.repeated_ids(), [])
        for target in page.links:
            self.assertEqual(target[0], "#", target)
            self.assertIn(target[1:], page.ids)
        for target in page.loads:
            self.assertTrue(target.startswith("data:image/png;base64,"), target[:60])
        self.assertEqual(page.outside_addresses(), [])
        self.assertIn(("viewport", "width=device-width,initial-scale=1"),
                      [(a.get("name"), a.get("content")) for t, a in page.elements if t == "meta"])
        for needed in ["prefers-color-scheme:dark", "@media print", "default-src 'none'"]:
            self.assertIn(needed, text)

    def test_every_subject_and_property_is_there(self):
        page, text = self.page("diffuse", "phong", "--only", "finite,reciprocity,description")
        words = page.words()
        models = {m["name"]: m for m in materials()}
        cards = [d["id"] for d in page.details if "id" in d]
        count = 0
        for name in ["diffuse", "phong"]:
            self.assertIn(f"model-{name}", page.ids)
            self.assertIn(f"{name}: {models[name]['title']}", words)
            for exemplar in models[name]["exemplars"]:
                self.assertIn(f"{name}/{exemplar['name']}", words)
                count += 1
        self.assertEqual(len(cards), count)
        for name in ["finite", "reciprocity", "description"]:
            self.assertIn(f"<b>{name}</b>", text)
        for line in ["Nothing failed.", f"{count} subjects, {2 * count + 2} checks", "faceta 0.",
                     "effort fast seed 0", "0.0001 in the whole suite"]:
            self.assertIn(line, words)
        self.assertEqual(text.count("<b>reciprocity</b>"), count + 1)
        self.assertLess(len(text), 150_000 * count)

    def test_plots_of_a_material_that_transmits(self):
        page, text = self.page("roughdielectric", "alpha=0.3", "--only", "finite,energy")
        titles = re.findall(r"<title id=[^>]*>([^<]*)</title>", text)
        kinds = ["Scattering lobes", "Sampling density", "Directional albedo", "Weights of samples"]
        for kind in kinds:
            mine = [t for t in titles if t.startswith(kind)]
            self.assertEqual(len(mine), 2, kind)
            self.assertEqual(sum("from inside" in t for t in mine), 1)
        self.assertEqual(sum(t.startswith("Reciprocity") for t in titles), 1)
        # Pictures of density beside samples, above and below the surface, from both sides; the map
        # of reciprocity; colour bars.
        pictures = [base64.b64decode(u.split(",")[1]) for u in page.loads]
        sizes = [struct.unpack(">II", p[16:24]) for p in pictures]
        self.assertEqual(sizes.count((72, 72)), 8)
        self.assertEqual(sizes.count((60, 60)), 1)
        # A single subject stands open. Its mean weight is its albedo: it loses next to nothing
        # where the viewer is not grazing.
        self.assertIn("open", [d for d in page.details if "id" in d][0])
        means = re.findall(r"<tr><td>(\d+)°</td><td class=\"n\">([\d.]+)</td>", text)
        self.assertEqual([int(a) for a, _ in means], [0, 30, 60, 80, 89, 100, 120, 150, 180])
        self.assertAlmostEqual(float(means[0][1]), 1, delta=0.02)

    def test_numbers_are_those_of_the_json(self):
        report = self.path("results.json")
        page, text = self.page("phong", "exponent=9", "--only", "chi2,energy", "--json", report)
        results = json.loads(report.read_text())
        self.assertEqual([p["figure"] for p in results["properties"]],
                         ["smallest p-value", "largest albedo"])
        words = page.words()
        for result in results["subjects"][0]["results"]:
            self.assertRegex(words, f"{result['property']} [^0-9]* ok {result['figure']:.4g}")

    def test_an_excuse_with_reason_and_reference(self):
        report = self.path("results.json")
        page, _ = self.page("orennayar", "sigma=0.3", "reflectance=1", "--only", "energy", "--json", report)
        (result,) = json.loads(report.read_text())["subjects"][0]["results"]
        self.assertIn("Oren and Nayar 1994", result["reference"])
        words = page.words()
        self.assertIn(f"energy orennayar sigma=0.3 reflectance=1 ({result['figure']:.4g}) "
                      f"{result['reason']} {result['reference']}", words)
        self.assertIn(f"Excused: {result['reason']} ({result['reference']})", words)

    def test_a_failure_and_a_name_that_must_be_escaped(self):
        name = """<script>alert("1 & 2")</script>"""
        escaped = name.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
        scene = self.path(
            "bright.xml",
            f"""<scene version="3.0.0"><bsdf type="diffuse" id="{escaped}">
                <float name="reflectance" value="1.5"/></bsdf>
                <bsdf type="phong" id="a/b"/><bsdf type="phong" id="a b">
                <float name="exponent" value="3"/></bsdf></scene>""",
        )
        page, text = self.page(scene, "--only", "energy,round_trip", code=1)
        self.assertNotIn("<script>alert", text)
        words = page.words()
        self.assertIn(name, words)
        self.assertIn("1 of 6 checks failed.", words)
        self.assertIn("What failed", words)
        self.assertRegex(words, r"energy no more light.* FAIL 1\.5")
        self.assertIn("albedo 1.5", words)
        self.assertIn("above its range, which only scene files can give", words)
        cards = {d["id"]: d for d in page.details if "id" in d}
        # Failed subjects stand open; ids of names that differ only in signs are unlike each other.
        self.assertEqual([("open" in d) for d in cards.values()], [True, False, False])
        self.assertIn("s-a-b", cards)
        self.assertIn("s-a-b-2", cards)

    def test_standard_output(self):
        process = run("verify", "-q", "diffuse", "reflectance=0.5", "--only", "finite", "--html", "-")
        self.assertEqual((process.returncode, process.stderr), (OK, ""))
        self.check(Page(process.stdout), process.stdout)

    def test_only_properties_of_models(self):
        page, text = self.page("diffuse", "--only", "description")
        self.assertNotIn("<svg", text)
        self.assertIn("description the model is described completely ok", page.words())

    def test_the_same_seed_gives_the_same_page(self):
        def once():
            text = self.page("roughconductor", "alpha=0.3", "--only", "chi2,energy")[1]
            return re.sub(r"<dt>time</dt><dd>[^<]*</dd>", "", text)

        self.assertEqual(once(), once())

    def test_errors(self):
        target = self.path("no") / "report.html"
        self.fail_with(INPUT_ERROR, "report.html", "verify", "-q", "diffuse", "--html", target)
        self.fail_with(USAGE, "cannot both", "verify", "-q", "diffuse", "--html", "-", "--json", "-")
        same = self.path("same")
        self.fail_with(USAGE, "cannot both", "verify", "-q", "diffuse", "--html", same, "--json", same)
        # A run that ends in an error leaves an old page as it was.
        old = self.path("old.html", "old")
        self.fail_with(INPUT_ERROR, "exponent", "verify", "-q", "phong", "exponent=-1", "--html", old)
        self.assertEqual(old.read_text(), "old")


if __name__ == "__main__":
    main()
