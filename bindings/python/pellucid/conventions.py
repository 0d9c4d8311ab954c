"""Converts the matrices of OpenGL, Vulkan and Direct3D renderers to Pellucid's structures.

Matrices are row-major and multiply column vectors. `depth` says what clip space has between near and far
plane: "-1..1" (OpenGL), "0..1" (Vulkan, Direct3D, OpenGL with glClipControl) or "1..0" (reversed; the far
plane may be infinitely far). `y_up`: whether clip space has y upwards, as OpenGL and Direct3D have, or
downwards, as Vulkan has. `first_row`: whether the first row of the image in memory is its "top" or its
"bottom", as glReadPixels gives it.
"""
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._types import Camera, Light

_DEPTHS = ("-1..1", "0..1", "1..0")  # PelClipDepth


def _set(target: Any, function: Any, view_projection: ArrayLike, depth: str, y_up: bool, first_row: str,
         wrong: str) -> Any:
    m = np.ascontiguousarray(view_projection, np.float32)
    if m.shape != (4, 4) or not np.isfinite(m).all():
        raise ValueError(f"view_projection has the shape {m.shape}; 4 x 4 finite numbers are needed")
    if depth not in _DEPTHS:
        raise ValueError(f"depth is {depth!r}; it must be one of {', '.join(_DEPTHS)}")
    if first_row not in ("top", "bottom"):
        raise ValueError(f"first_row is {first_row!r}; it must be 'top' or 'bottom'")
    if not function(m.ctypes.data, _DEPTHS.index(depth), not y_up, first_row == "bottom", target._data):
        raise ValueError(f"view_projection {wrong}")
    return target


def camera_from_view_projection(view_projection: ArrayLike, depth: str = "-1..1", y_up: bool = True,
                                **fields: Any) -> Camera:
    """The camera of a G-buffer whose depth image is what the depth buffer holds, its first row on top.

    The position is where the projection puts it: far away in front of the middle of the picture for
    a parallel one.
    """
    camera: Camera = _set(Camera(**fields), _native.camera_of, view_projection, depth, y_up, "top",
                          "has no inverse")
    return camera


def light_from_view_projection(view_projection: ArrayLike, depth: str = "-1..1", y_up: bool = True,
                               first_row: str = "top", **fields: Any) -> Light:
    """A light whose shadow map was drawn with this matrix: directional if it is parallel, else a spot.

    `fields` are others of Light, such as `color`. For a spot, `spot_cos_inner` and `spot_cos_outer` are left
    to the caller.
    """
    light: Light = _set(Light(**fields), _native.light_of, view_projection, depth, y_up, first_row,
                        "makes no depth")
    return light
