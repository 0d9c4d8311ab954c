"""Checks that programs built against an older or newer pellucid.h keep working.

    check_abi.py list HEADER_DIR              prints what the header promises now: functions, values, sizes
    check_abi.py check HEADER_DIR LIBRARY     compares with promises.txt; that the library exports what the
                                              header declares and nothing else

A function or value in promises.txt stays; a structure may only grow, at its end, and a ..._COUNT. CC and
CFLAGS choose the compiler.
"""
import os
import re
import shlex
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

HERE = Path(__file__).resolve().parent
CC = [*shlex.split(os.environ.get("CC", "cc")), *shlex.split(os.environ.get("CFLAGS", "")), "-std=c99",
      "-Wall", "-Werror"]


def run(*command):
    return subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def promises(include):
    """{"function pelX": 0, "value PEL_X": number, "size PelX": bytes} as the compiler sees the header."""
    text = (include / "pellucid/pellucid.h").read_text(encoding="utf-8")
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    functions = re.findall(r"PEL_API[^;(]*?\b(pel\w+)\(", code)
    values = re.findall(r"\b(PEL_[A-Z0-9_]+)\s*=", code)
    sizes = re.findall(r"typedef struct (Pel\w+) \{", code)
    if min(len(functions), len(values), len(sizes)) < 15:
        found = f"{len(functions)} functions, {len(values)} values, {len(sizes)} structures"
        raise SystemExit(f"only {found}: this script is broken")
    with tempfile.TemporaryDirectory() as work:
        lines = [f'printf("value {v} %lld\\n", (long long){v});' for v in values]
        lines += [f'printf("size {s} %lld\\n", (long long)sizeof({s}));' for s in sizes]
        source = Path(work, "list.c")
        source.write_text("\n".join(["#include <pellucid/pellucid.h>", "#include <stdio.h>",
                                     "int main(void) {", *lines, "return 0; }"]))
        run(*CC, "-I", include, source, "-o", Path(work, "list"))
        measured = [line.rsplit(" ", 1) for line in run(Path(work, "list")).splitlines()]
    return {f"function {f}": 0 for f in functions} | {name: int(number) for name, number in measured}


def broken_promises(then, now):
    for name, number in then.items():
        if name not in now:
            yield f"{name} was promised and is gone"
        elif name.startswith("size") and now[name] < number:
            yield f"{name} was {number} and is {now[name]}: a structure may only grow"
        elif name.endswith("_COUNT") and now[name] < number:
            yield f"{name} was {number} and is {now[name]}: there may only be more"
        elif name.startswith("value") and not name.endswith("_COUNT") and now[name] != number:
            yield f"{name} was {number} and is {now[name]}"


def main(what, include, library=None):
    include = Path(include).resolve()
    now = promises(include)
    if what == "list":
        for kind in ("function", "value", "size"):
            names = [f"{name.split()[1]}={number}" if kind != "function" else name.split()[1]
                     for name, number in now.items() if name.startswith(kind)]
            print(textwrap.fill(" ".join(names), 110, initial_indent=f"{kind} ", subsequent_indent=f"{kind} ",
                                break_on_hyphens=False))
        return
    then = {}
    for line in (HERE / "promises.txt").read_text().splitlines()[1:]:
        kind, *names = line.split()
        then |= {f"{kind} {name}": int(number or 0) for name, _, number in (n.partition("=") for n in names)}
    library = Path(library).resolve()
    exported = {line.split()[-1] for line in run("nm", "-D", "--defined-only", library).splitlines()}
    declared = {name.split()[1] for name in now if name.startswith("function")}
    wrong = list(broken_promises(then, now))
    wrong += [f"{n} is declared or exported, and not both" for n in sorted(exported ^ declared)]
    # The comparison itself must be able to fail.
    assert len(list(broken_promises({"size A": 8, "value B": 1, "function c": 0, "value D_COUNT": 3},
                                    {"size A": 4, "value B": 2, "value D_COUNT": 2}))) == 4
    if wrong:
        raise SystemExit("\n".join(wrong))
    print(f"{len(then)} promises kept")


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        raise SystemExit(__doc__)
    main(*sys.argv[1:])
