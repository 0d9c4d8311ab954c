#!/usr/bin/env python3
"""test_warps.py BUILD_DIR: warps.cpp counts right for kernels whose counts are known."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import run

KERNELS = """
__kernel void even(__global float* a) { a[get_global_id(0)] += 1.0f; }
__kernel void strided(__global float* a) { a[8 * get_global_id(0)] += 1.0f; }
__kernel void quarter(__global float* a) {
    const uint i = get_global_id(0);
    float x = a[i];
    if (i % 32 < 8)
        for (int k = 0; k < 1000; ++k) x *= 0.5f;
    a[i] = x;
}
__kernel void conflicts(__global float* a, __local float* l) {
    l[32 * get_local_id(0)] = a[get_global_id(0)];
}
"""
# Of two warps of 32 lanes: share of active lanes, sectors over the least, bytes moved, replays.
EXPECTED = {"even": (1, 1, 256, 0), "strided": (1, 8, 2048, 0), "quarter": (0.25, 1, 256, 0),
            "conflicts": (1, 1, 256, 2 * 31)}


def main():
    if not shutil.which("oclgrind-kernel") or not Path("/usr/include/oclgrind/Plugin.h").exists():
        print("skipped: oclgrind and liboclgrind-dev are not installed")
        return 77
    plugin, wrong = run.plugin(Path(sys.argv[1]).resolve(), "warps"), 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "known.cl").write_text(KERNELS)
        for kernel, expected in EXPECTED.items():
            local = "<size=8192>\n" if kernel == "conflicts" else ""
            (folder / "known.sim").write_text(
                f"known.cl\n{kernel}\n64 1 1\n64 1 1\n<size=2048 fill=1 float>\n{local}")
            subprocess.run(["oclgrind-kernel", "--plugins", plugin, "known.sim"], cwd=folder, check=True,
                           env={**os.environ, "PELLUCID_WARPS": str(folder / kernel)})
            c = json.loads((folder / kernel).read_text())
            found = (round(c["instructions"] / c["slots"], 2), c["sectors"] / c["least"], c["moved"],
                     c["replays"])
            wrong += found != expected
            print(f"{kernel}: {found}" + (f", not {expected}" if found != expected else ""))
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
