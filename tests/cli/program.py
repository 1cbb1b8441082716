"""What the tests of the command line share: running the program, tables, single precision."""

import csv
import io
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

OK, CHECK_FAILED, USAGE, INPUT_ERROR = 0, 1, 2, 3
PROGRAM = None
TIMEOUT = int(os.environ.get("FACETA_TEST_TIMEOUT", 300)) - 50


def run(*arguments, stdin=""):
    """The finished process, its output as text."""
    return subprocess.run(
        [PROGRAM, *map(str, arguments)], input=stdin, capture_output=True, text=True, timeout=TIMEOUT
    )


def to_float32(value):
    """The nearest single-precision number."""
    return struct.unpack("f", struct.pack("f", float(value)))[0]


def read_table(text):
    """The rows of a CSV text as dictionaries of texts."""
    return list(csv.DictReader(io.StringIO(text)))


def write_pfm(path, width, height, pixel):
    """A colour PFM; pixel(x, y) gives r, g, b with y counted from the top."""
    rows = [[pixel(x, y) for x in range(width)] for y in reversed(range(height))]
    data = b"".join(struct.pack("<3f", *p) for row in rows for p in row)
    Path(path).write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + data)


def materials(role="model"):
    """The descriptions of all models, of the nodes of scene files, or (role=None) of both."""
    everything = json.loads(run("materials", "--json").stdout)
    return [m for m in everything if role in (None, m["role"])]


def has_material(name):
    return any(m["name"] == name for m in materials())


class Case(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def path(self, name, text=None):
        path = self.folder / name
        if text is not None:
            path.write_bytes(text.encode())
        return path

    def succeed(self, *arguments, stdin=""):
        """The standard output of a run that must end well and quietly."""
        process = run(*arguments, stdin=stdin)
        self.assertEqual((process.returncode, process.stderr), (OK, ""))
        return process.stdout

    def fail_with(self, code, pattern, *arguments, stdin=""):
        """A run that must end with this exit code, a message like the pattern and no data."""
        process = run(*arguments, stdin=stdin)
        self.assertEqual(process.returncode, code, process.stderr)
        self.assertRegex(process.stderr, pattern)
        self.assertEqual(process.stdout, "")
        return process.stderr


def main():
    global PROGRAM
    # The test scripts import this file as a module of its own.
    module = sys.modules["program"]
    module.PROGRAM = str(Path(sys.argv.pop(1)).resolve())
    unittest.main(module="__main__")
