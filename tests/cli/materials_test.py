"""The list of materials and the description of each, in its three forms."""

import json
import math
import xml.etree.ElementTree as ElementTree

from program import INPUT_ERROR, Case, main, materials, read_table

TAGS = {"colour": "rgb", "number": "float", "word": "string", "flag": "boolean", "metal": "string"}


class Materials(Case):
    def test_list_has_a_name_and_a_title_a_line(self):
        lines = self.succeed("materials").splitlines()
        self.assertEqual(
            [line.split(None, 1) for line in lines], [[m["name"], m["title"]] for m in materials(None)]
        )
        self.assertIn("diffuse", [m["name"] for m in materials()])

    def test_description_tells_everything(self):
        for m in materials(None):
            with self.subTest(m["name"]):
                text = self.succeed("materials", m["name"])
                self.assertTrue(text.startswith(f"{m['name']}: {m['title']}\n"))
                for line in m["equation"].splitlines():
                    self.assertIn(line.strip(), text)
                for p in m["parameters"]:
                    self.assertRegex(text, rf"(?m)^  {p['name']} .*{p['meaning'][:10]}")
                for part in m["references"] + m["notes"] + [e["reason"] for e in m["exceptions"]]:
                    self.assertIn(part, text)
                self.assertIn(m["xml"], text)

    def test_json_of_one_is_its_entry_in_all(self):
        for m in materials(None):
            self.assertEqual(json.loads(self.succeed("materials", m["name"], "--json")), m)

    def test_markdown(self):
        rows = self.succeed("materials", "--markdown").splitlines()
        self.assertEqual(len(rows), 2 + len(materials(None)))
        self.assertEqual({row.count("|") - row.count("\\|") for row in rows}, {4})
        for row, m in zip(rows[2:], materials(None)):
            self.assertTrue(row.startswith(f"| `{m['name']}` |"))
            text = self.succeed("materials", m["name"], "--markdown")
            self.assertIn("```xml\n" + m["xml"] + "```\n", text)
            table = [line for line in text.splitlines() if line.startswith("|")]
            if m["parameters"]:
                self.assertEqual(len(table), 2 + len(m["parameters"]))
                self.assertEqual({r.count("|") - r.count("\\|") for r in table}, {8})

    def test_snippet_gives_every_parameter_one_way(self):
        for m in materials(None):
            with self.subTest(m["name"]):
                bsdf = ElementTree.fromstring(m["xml"])
                self.assertEqual((bsdf.tag, bsdf.get("type")), ("bsdf", m["name"]))
                given = {e.get("name"): e for e in bsdf if e.tag != "bsdf"}
                wanted = {p["name"]: p for p in m["parameters"] if "instead_of" not in p}
                self.assertEqual(list(given), list(wanted))
                for name, p in wanted.items():
                    if p["kind"] in TAGS:
                        self.assertEqual(given[name].tag, TAGS[p["kind"]])

    def test_defaults_in_the_snippet_are_accepted_as_settings(self):
        header = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z\n"
        for m in materials():
            with self.subTest(m["name"]):
                settings = [
                    f"{e.get('name')}={e.get('value')}".replace(", ", ",")
                    for e in ElementTree.fromstring(m["xml"])
                ]
                files = [s for s in settings if s.startswith("filename=")]  # has no default
                row = header + "0,0,1,0.6,0,0.8\n"
                self.assertEqual(
                    self.succeed("eval", m["name"], *settings, stdin=row),
                    self.succeed("eval", m["name"], *files, stdin=row),
                )

    def test_nodes_of_scene_files(self):
        self.assertEqual(
            [m["name"] for m in materials("node")], ["twosided", "mask", "blendbsdf", "null"]
        )
        for m in materials("node"):
            self.fail_with(INPUT_ERROR, "--scene FILE --id ID", "eval", m["name"])
        self.fail_with(INPUT_ERROR, "did you mean 'twosided'", "materials", "two-sided")

    def test_snippets_of_nodes_are_read_and_do_what_they_say(self):
        # Lambert's 0.5 / pi cos theta, seen from above and from below.
        lambert = 0.5 / math.pi * 0.8
        expected = {
            "twosided": [lambert, lambert],
            "mask": [0.5 * lambert, 0],
            "blendbsdf": [0.5 * lambert, 0],
            "null": [0, 0],
        }
        rows = "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z\n0,0,1,0.6,0,0.8\n0,0,-1,0.6,0,-0.8\n"
        for m in materials("node"):
            with self.subTest(m["name"]):
                xml = m["xml"].replace("<bsdf ", '<bsdf id="it" ', 1)
                scene = self.path("scene.xml", f'<scene version="3.0.0">{xml}</scene>')
                table = read_table(
                    self.succeed("eval", "--scene", scene, "--id", "it", stdin=rows)
                )
                for row, value in zip(table, expected[m["name"]], strict=True):
                    self.assertAlmostEqual(float(row["value_g"]), value, places=6)


if __name__ == "__main__":
    main()
