"""The page of measurements (apps/bench/page.py): every kept result is on it, and a broken one is refused by name."""

from __future__ import annotations

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

BENCH = pathlib.Path(__file__).resolve().parents[2] / "apps/bench"
MEASUREMENT = {"title": "Speed", "command": "palpate bench build", "columns": ["points", "us"],
               "rows": [[1000, [1.5, 2]]]}
SUMMARY = {"n": 5, "min": 1, "p50": 1234.5678, "p99": 3, "p999": 2345.6, "max": 4}
# As `palpate bench touch --json` and its like write it.
WRITTEN = {"machines": {"cpu": "a machine"},
           "run": {"command": "palpate bench touch", "date": "2026-11-28", "version": "0.1.0"},
           "touch": {"M5_plates": [], "judgements": [
               {"backend": "cpu", "points": 200000, "step": {"us": SUMMARY, "gpu_us": None}, "force_N": [0.1] * 50,
                "slides": [{"speed": 50.0}, {"speed": 200.0, "held": True}]}]}}


def page(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, BENCH / "page.py", *map(str, arguments)], capture_output=True, text=True)


def rows_of(text: str) -> list[list[str]]:
    return [re.split(r"(?<!\\)\|", line)[1:-1] for line in text.splitlines() if line.startswith("|")]


class Page(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def made(self, content: object) -> str:
        (self.folder / "kept.json").write_text(content if isinstance(content, str) else json.dumps(content))
        self.result = page("-o", self.folder / "page.md", self.folder)
        return (self.folder / "page.md").read_text() if self.result.returncode == 0 else ""

    def test_every_kept_measurement_is_on_the_page(self):
        result = page("-o", self.folder / "page.md")
        self.assertEqual(result.returncode, 0, result.stderr)
        text = (self.folder / "page.md").read_text()
        kept = [each for file in (BENCH / "results").glob("*.json") for each in json.loads(file.read_text())
                if isinstance(each, dict)]
        self.assertGreater(len(kept), 30)
        for each in kept:
            self.assertEqual(text.count(f"\n## {each['title']}\n"), 1, each["title"])
        widths = [len(row) for row in rows_of(text)]
        self.assertGreaterEqual(len(widths), sum(2 + len(each["rows"]) for each in kept))
        for block in re.findall(r"(?:^\|.*\n)+", text, re.M):
            self.assertEqual(len({len(row) for row in rows_of(block)}), 1, block)
        for picture in re.findall(r"!\[.*?\]\((.*?)\)", text):
            self.assertTrue((self.folder / picture).is_file(), picture)

    def test_cells_keep_their_digits(self):
        self.assertIn("| 1,000 | 1.50 / 2 |", self.made(json.dumps([MEASUREMENT]).replace("1.5", "1.50")))

    def test_what_a_bench_wrote_needs_no_editing(self):
        text = self.made(WRITTEN)
        for line in ("palpate bench touch", "cpu: a machine, palpate 0.1.0; 2026-11-28; median / p99.9",
                     "| backend | points | step.us | step.gpu_us |", "| cpu | 200,000 | 1,235 / 2,346 | – |",
                     "`touch.judgements.slides`", "| backend | speed | held |", "| cpu | 50.0 | – |"):
            self.assertIn(f"{line}\n", text)
        older = {key: WRITTEN[key] for key in ("machines", "touch")}
        self.assertIn("cpu: a machine; median / p99.9\n", self.made(older))

    def test_a_broken_file_is_refused_by_name(self):
        broken = [("{", "not valid JSON"), ({}, "neither a list"), ({"machines": {}}, "no measurement"),
                  ([1], "wrong kind"), ([MEASUREMENT | {"rows": [[1]]}], "row 1 has 1 cells for 2 columns"),
                  ([MEASUREMENT | {"note": "?"}], "unknown keys: note"),
                  ([MEASUREMENT | {"picture": "no.png"}], "no picture no.png")]
        for key in MEASUREMENT:
            broken.append(([{k: v for k, v in MEASUREMENT.items() if k != key}], f"lacks {key}"))
        for content, reason in broken:
            with self.subTest(reason):
                self.assertEqual(self.made(content), "")
                self.assertEqual(self.result.returncode, 1)
                self.assertIn("kept.json", self.result.stderr)
                self.assertIn(reason, self.result.stderr)


if __name__ == "__main__":
    unittest.main()
