"""Doxygen's filter: ordinary comments of a header become documentation; the header stays free of marks.

A comment on lines of its own describes what follows, one behind code what stands before it. A heading (/*
---- Words ---- */) stays out.
"""

import re
import sys

HEADING = re.compile(r"-{4}")


def marked(text: str) -> str:
    """The same text, line for line, with documentation marks."""
    out = []
    for line in text.split("\n"):
        before, mark, rest = line.partition("//")
        if mark and '"' not in before and not HEADING.search(rest):
            if before.strip():
                line = f"{before}///<{rest}"
            else:
                line = f"{before}///{rest}"
        out.append(line)
    text = "\n".join(out)

    def block(match: re.Match) -> str:
        start = text.rfind("\n", 0, match.start()) + 1
        behind = text[start : match.start()].strip()
        if HEADING.search(match.group(0)) or "SPDX" in match.group(0):
            return match.group(0)
        # The first comment of a file is about the file.
        return ("/**<" if behind else "/** @file\n *" if match.start() == 0 else "/**") + match.group(0)[2:]

    if text.startswith("///"):
        text = "/// @file\n" + text
    return re.sub(r"/\*(?![*<]).*?\*/", block, text, flags=re.S)


if __name__ == "__main__":
    sys.stdout.write(marked(open(sys.argv[1], encoding="utf-8").read()))
