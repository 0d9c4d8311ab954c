#!/usr/bin/env python3
"""tests/plain_english.py [FILE|FOLDER ...]: words that the project does not use (tests/words.txt), and lines that are too long.

Code and comments have at most 110 columns, prose in Markdown at most 120; tables, code blocks, links and headings of Markdown may be
longer. Without arguments, every file that git tracks.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CODE = {".cpp", ".h", ".hpp", ".c", ".cl", ".clh", ".py", ".pyi"}
SKIPPED = {"tests/words.txt", "tests/plain_english.py"}


def tracked(places):
    names = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *places], cwd=ROOT, check=True,
                           capture_output=True, text=True).stdout.split("\n")
    return sorted({name for name in names if name and name not in SKIPPED and (ROOT / name).is_file()})


def rules():
    for line in (ROOT / "tests/words.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            pattern, instead = line.split("\t")
            yield re.compile(pattern, re.I if pattern.islower() else 0), instead


def main():
    words, found = list(rules()), 0
    for name in tracked([str(pathlib.Path(a).resolve()) for a in sys.argv[1:]] or ["."]):
        path = ROOT / name
        prose = path.suffix == ".md"
        if not prose and path.suffix not in CODE:
            continue
        limit, block = 120 if prose else 110, False
        for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
            block ^= prose and line.lstrip().startswith("```")
            free = prose and (block or line.startswith("    ") or line.lstrip().startswith(("|", "#")) or re.match(r"\W*!?\[[^]]*\]\(\S+\)\W*$", line))
            if len(line) > limit and not free and not re.search(r"https?://\S{60}", line):
                print(f"{name}:{number}: {len(line)} columns, at most {limit}")
                found += 1
            for pattern, instead in words:
                if match := pattern.search(line):
                    print(f"{name}:{number}: '{match[0]}': {instead}")
                    found += 1
    print(f"{found} findings", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
