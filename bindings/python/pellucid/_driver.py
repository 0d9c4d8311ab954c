"""The OpenCL driver that ``pip install pellucid[cpu]`` brings, for machines without one."""
from __future__ import annotations

import os
import site
import sys


def offer() -> None:
    """Names that driver as the last library to try, unless PELLUCID_OPENCL names some already.

    Loaders do not find it: its registration file, intel-cpu.icd, is outside the folders that loaders search,
    and has a placeholder instead of the driver's path.
    """
    if not sys.platform.startswith("linux") or os.environ.get("PELLUCID_OPENCL"):
        return
    for prefix in (sys.prefix, site.USER_BASE, os.path.dirname(os.path.dirname(os.path.dirname(__file__)))):
        driver = os.path.join(prefix or "", "lib", "libintelocl.so")
        if os.path.exists(driver):
            os.environ["PELLUCID_OPENCL"] = f"libOpenCL.so.1:libOpenCL.so:{driver}"
            return
