"""Pellucid: subsurface scattering for deferred renderers, on OpenCL.

Lengths (positions, radii, widths, thickness) are in any one unit, the same for all, with defaults in
millimetres; curvature is in 1/length; colours are linear RGB; matrices are row-major and multiply column
vectors. NumPy arrays are used in place, with any positive strides; nothing is copied unless the
documentation of a parameter says so. Work runs without the GIL, and arrays stay alive until the work that
uses them is done. Failures raise `PellucidError`.
"""
from __future__ import annotations

from typing import Any

from . import _driver, _native
from ._arrays import Image, Vertices
from ._errors import PellucidError
from ._struct import did_you_mean
from ._types import *  # noqa: F401,F403
from ._types import __all__ as _type_names
from .device import Buffer, Device, Event, devices, set_error_callback, set_log_callback
from .lut import Lut
from .mesh import LiveMesh, MeshTopology, orient_mesh, screen_curvature, submit_screen_curvature
from .profile import Profile
from .scatter import Scatter, TextureScatter, compare, flip, submit_surface_integral, surface_integral
from .scene import Scene, Shaded, load_scene, shade
from .shader import Shader, warm_up_programs
from .skin import skin_albedo, skin_from_albedo, skin_info, skin_reflectance

_driver.offer()


_OF_FILES = ("load_mesh", "load_profile", "read_image", "tonemap", "write_image")


def __getattr__(name: str) -> Any:
    # Of a module that not every build has.
    if name in _OF_FILES:
        from . import files

        return getattr(files, name)
    if name == "load_gltf":
        from .gltf import load_gltf

        return load_gltf
    raise AttributeError(f"module 'pellucid' has no attribute {name!r}{did_you_mean(name, __all__)}")


def __dir__() -> list[str]:
    return sorted([*__all__, *_OF_FILES, "__doc__", "__version__", "files", "load_gltf"])


_number = _native.version()
__version__ = f"{_number // 10000}.{_number // 100 % 100}.{_number % 100}"

__all__ = [  # noqa: PLE0604
    "Buffer", "Device", "Event", "Image", "LiveMesh", "Lut", "MeshTopology", "PellucidError", "Profile",
    "Scatter", "Scene", "Shaded", "Shader", "TextureScatter", "Vertices", "compare", "devices", "flip",
    "load_scene", "orient_mesh", "screen_curvature", "set_error_callback", "set_log_callback", "shade",
    "skin_albedo", "skin_from_albedo", "skin_info", "skin_reflectance",
    "submit_screen_curvature", "submit_surface_integral", "surface_integral",
    "warm_up_programs", *_type_names]
