"""The package as it is installed."""
import re
from importlib import metadata, resources
from pathlib import Path

import pellucid as pel

ROOT = Path(__file__).resolve().parents[3]


def test_version_is_the_projects():
    version = re.search(r"project\(pellucid VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    assert pel.__version__ == version == metadata.version("pellucid")


def test_both_ways_in_describe_one_package():
    here = (ROOT / "bindings/python/pyproject.toml").read_text().splitlines()[1:]
    root = (ROOT / "pyproject.toml").read_text().splitlines()[1:]
    different = [(a, b) for a, b in zip(here, root) if a != b]
    assert len(here) == len(root)
    assert len(different) == 5 and all("=" in a and a.split("=")[0] == b.split("=")[0] for a, b in different)


def test_types_and_the_library_are_inside():
    files = {f.name for f in resources.files("pellucid").iterdir()}
    assert {"py.typed", "_types.py", "_native.pyi", "libpellucid.so"} <= files
