"""Writes a table in every format with the built command and reads it with other people's readers.

    run.py PELLUCID WORK

PELLUCID is the command, WORK a folder that keeps a virtual environment with the readers. A reader that
cannot be installed is skipped with a message; then this ends with 77, as CTest knows it.
"""

import subprocess
import sys
import venv
from pathlib import Path

READERS = ["numpy", "pillow", "imagecodecs", "OpenEXR", "pyktx2"]


def main(command, work):
    environment = Path(work).resolve() / "readers"
    python, complete = environment / "bin/python", environment / "complete"
    if not complete.exists():
        venv.create(environment, clear=True, with_pip=True)
        for reader in READERS:
            install = "-m pip --disable-pip-version-check install -q --only-binary :all:".split()
            found = subprocess.run([python, *install, reader], capture_output=True)
            if found.returncode and reader == "numpy":
                print("tests/foreign::packages_from_PyPI SKIPPED (pip cannot reach what the tests need)")
                return 77
        complete.touch()
    return subprocess.run([python, Path(__file__).parent / "read_tables.py", command]).returncode


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    raise SystemExit(main(*sys.argv[1:]))
