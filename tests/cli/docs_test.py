"""faceta docs: the committed pages are those of these materials, and a stale page is told."""

import re
import shutil
from pathlib import Path
from urllib.parse import unquote

from page import Page
from program import CHECK_FAILED, OK, USAGE, Case, main, materials, run

SITE = Path(__file__).resolve().parents[2] / "docs" / "site"


class Docs(Case):
    def check(self, folder):
        process = run("docs", "--check", folder)
        self.assertEqual(process.stderr, "")
        self.assertEqual(process.returncode, CHECK_FAILED if process.stdout else OK)
        return process.stdout

    def copy(self):
        return Path(shutil.copytree(SITE, self.folder / "site"))

    def change(self, path, pattern, replacement):
        text = path.read_text(encoding="utf-8")
        changed, count = re.subn(pattern, replacement, text, count=1, flags=re.S)
        self.assertEqual(count, 1, pattern)
        path.write_text(changed, encoding="utf-8")

    def test_the_committed_pages_are_up_to_date(self):
        self.assertEqual(self.check(SITE), "", "`make docs` writes them anew")

    def test_pages_are_whole(self):
        pages = {}
        for path in sorted(SITE.rglob("*.html")):
            text = path.read_bytes().decode("utf-8")
            pages[path] = Page(text)
            self.assertEqual(pages[path].errors, [], path)
            self.assertEqual(pages[path].repeated_ids(), [], path)
            self.assertEqual(pages[path].outside_addresses(), [], path)
        self.assertEqual(len(pages), len(materials(role=None)) + 2)
        for path, page in pages.items():
            for target in page.links + page.loads:
                if target.startswith("data:image/png;base64,"):
                    continue
                name, _, anchor = unquote(target).partition("#")
                file = (path.parent / name).resolve() if name else path
                self.assertTrue(file.is_file(), f"{path}: {target}")
                if anchor:
                    self.assertIn(anchor, pages[file].ids, f"{path}: {target}")

    def test_a_page_tells_what_the_descriptor_says(self):
        for m in materials(role=None):
            words = Page((SITE / "materials" / f"{m['name']}.html").read_text("utf-8")).words()
            for part in [m["title"], m["equation"], m["xml"], *m["references"], *m["notes"]]:
                self.assertIn(" ".join(part.split()), words)
            for p in m["parameters"]:
                self.assertIn(f"{p['name']} {p['kind']} {p['default']}", words)
            for e in m["exceptions"]:
                self.assertIn(f"{e['property']}: {e['reason']} ({e['reference']})", words)

    def test_size(self):
        self.assertLess(sum(f.stat().st_size for f in SITE.rglob("*") if f.is_file()), 12 << 20)

    def test_a_changed_word_is_stale(self):
        site = self.copy()
        self.change(site / "materials" / "phong.html", "cosine|cos", "sine")
        text = self.check(site)
        self.assertRegex(text, r"phong\.html is stale at line \d+:\n  it says .*sine")
        self.assertIn("1 complaints; `make docs`", text)

    def test_values_may_be_a_little_off(self):
        site = self.copy()
        page = site / "materials" / "diffuse.html"
        pattern = r"<!--values diffuse/grey ([\d.]+) "

        def times(factor):
            value = float(re.search(pattern, page.read_text("utf-8")).group(1))
            self.change(page, pattern, f"<!--values diffuse/grey {value * factor:.9g} ")

        times(1.0005)
        self.assertEqual(self.check(site), "")
        times(1.01)
        self.assertRegex(self.check(site), r"diffuse\.html is stale")

    def test_what_is_missing_or_too_much(self):
        site = self.copy()
        (site / "materials" / "ward.html").unlink()
        (site / "pictures" / "phong-1.png").unlink()
        (site / "materials" / "wax.html").write_text("")
        self.change(site / "index.html", "(<!--measured-->).*?(<!--/measured-->)", r"\1\2")
        self.change(site / "report.html", "<b>diffuse/grey</b>", "")
        text = self.check(site)
        for line in ["ward.html is missing", "phong-1.png is missing", "wax.html belongs to no material",
                     "index.html lacks what is measured", "report.html lacks diffuse/grey", "5 complaints"]:
            self.assertIn(line, text)

    def test_an_empty_folder(self):
        text = self.check(self.folder)
        self.assertIn("index.html is missing", text)

    def test_usage(self):
        self.fail_with(USAGE, "folder", "docs")


if __name__ == "__main__":
    main()
