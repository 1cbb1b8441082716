"""What the scene tests share: running the program, skipping, and the last line.

Standard library only. Each script is called as
    SCRIPT PROGRAM [--shared FOLDER] [--only NAME]...
and ends with 0 (all good), 1 (something failed) or 77 (nothing to test here).
FACETA_SCENES_QUICK=1 takes fewer samples: for developers, not for CI.
"""

import argparse
import json
import os
import subprocess
import tempfile
import time
from pathlib import Path

SKIPPED = 77
QUICK = os.environ.get("FACETA_SCENES_QUICK") == "1"
ROOT = Path(__file__).resolve().parents[2]


def arguments(description):
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("program", help="the faceta program")
    parser.add_argument("--shared", type=Path, default=ROOT.parent / "shared" / "data",
                        help="folder of third-party data (default: %(default)s)")
    parser.add_argument("--only", action="append", default=[], help="scenes with this in their name")
    return parser.parse_args()


class Failure(Exception):
    """The program ended otherwise than it should; the text is its complaint."""


def run(program, *words, codes=(0,)):
    """Standard output of the program."""
    try:
        result = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    except OSError as error:
        raise Failure(f"{program}: {error.strerror}") from error
    if result.returncode not in codes:
        complaint = result.stderr.strip().splitlines()[-1:] or ["no message"]
        raise Failure(f"exit code {result.returncode} of 'faceta {words[0]}': {complaint[0]}")
    return result.stdout


def run_json(program, *words, codes=(0,)):
    return json.loads(run(program, *words, codes=codes))


class Summary:
    """Runs one function a scene and counts how they end."""

    def __init__(self, options, title):
        self.options, self.title = options, title
        self.passed, self.failed, self.skipped, self.hints = [], [], [], []
        self.start = time.monotonic()
        self.folder = tempfile.TemporaryDirectory(prefix="faceta_scenes_")

    def path(self, name):
        """A file in a folder that goes away at the end."""
        return Path(self.folder.name) / name

    def scene(self, name, test, needs=()):
        """test() returns (passed, line, hints)."""
        if self.options.only and not any(word in name for word in self.options.only):
            return
        missing = [file for file in needs if not Path(file).exists()]
        if missing:
            self.skipped.append(name)
            print(f"skip  {name:<44} there is no {missing[0]}", flush=True)
            return
        begun = time.monotonic()
        try:
            good, line, hints = test()
        except Failure as failure:
            good, line, hints = False, str(failure), []
        (self.passed if good else self.failed).append(name)
        seconds = time.monotonic() - begun
        print(f"{'pass' if good else 'FAIL'}  {name:<44} {line}  [{seconds:.1f} s]", flush=True)
        for hint in hints:
            self.hints.append(name)
            print(f"      {'':<44} look for the reason: {hint}", flush=True)

    def end(self, known=None):
        """Prints the reasons that are known and the last line. Returns the exit code."""
        for name in sorted(set(self.hints) & set(known or {})):
            print(f"known {name}: {known[name]}")
        unexplained = sorted(set(self.hints) - set(known or {}))
        seconds = time.monotonic() - self.start
        text = (f"{self.title}: {len(self.passed)} passed, {len(self.failed)} failed, "
                f"{len(self.skipped)} skipped in {seconds:.0f} s")
        if QUICK:
            text += " (quick mode: fewer samples)"
        if unexplained:
            text += f"; look at: {', '.join(unexplained)}"
        if self.failed:
            text += f"; failed: {', '.join(self.failed)}"
        print(text, flush=True)
        self.folder.cleanup()
        if self.failed:
            return 1
        return 0 if self.passed else SKIPPED
