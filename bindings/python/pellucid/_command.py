"""The ``pellucid`` command of the package: its own subcommands, and the compiled program for the others."""
from __future__ import annotations

import os
import sys
from pathlib import Path

_OWN = ("view", "gallery")


def program() -> Path:
    """The compiled program of the package; it may be missing."""
    return Path(__file__).parent / "bin" / "pellucid"


def main() -> int:
    name = sys.argv[1] if len(sys.argv) > 1 else ""
    if name in _OWN:
        del sys.argv[1]
        if name == "view":
            from .view.__main__ import main as run
        else:
            from .view.gallery import main as run
        return run()
    if program().exists():
        os.execv(program(), ["pellucid", *sys.argv[1:]])  # does not come back
    print("pellucid: this package was built without the program, which needs CLI11 and nlohmann-json "
          "(Debian: libcli11-dev "
          f"nlohmann-json3-dev, beside what pellucid.files needs); there are {' and '.join(_OWN)}",
          file=sys.stderr)
    return 2


if __name__ == "__main__":
    raise SystemExit(main())
