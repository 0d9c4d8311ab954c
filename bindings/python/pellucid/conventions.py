"""Matrices of renderers: from what OpenGL, Vulkan and Direct3D hand to a shader, to what Pellucid takes.

Matrices are row-major and multiply column vectors. `depth` says what clip space has between near and far
plane: "-1..1" (OpenGL), "0..1" (Vulkan, Direct3D, OpenGL with glClipControl) or "1..0" (reversed; the far
plane may be infinitely far). `y_up`: whether clip space has y upwards, as OpenGL and Direct3D have, or
downwards, as Vulkan has. `first_row`: whether the first row of the image in memory is its "top" or its
"bottom", as glReadPixels gives it.
"""
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._types import Camera, Light, ShadowProjection

_DEPTHS = ("-1..1", "0..1", "1..0")


def _matrix(value: ArrayLike, what: str) -> NDArray[np.float64]:
    m = np.asarray(value, np.float64)
    if m.shape != (4, 4) or not np.isfinite(m).all():
        raise ValueError(f"{what} has the shape {m.shape}; 4 x 4 finite numbers are needed")
    return m


def _check(depth: str, first_row: str) -> None:
    if depth not in _DEPTHS:
        raise ValueError(f"depth is {depth!r}; it must be one of {', '.join(_DEPTHS)}")
    if first_row not in ("top", "bottom"):
        raise ValueError(f"first_row is {first_row!r}; it must be 'top' or 'bottom'")


def clip_to_image(depth: str = "-1..1", y_up: bool = True, first_row: str = "top") -> NDArray[np.float64]:
    """Homogeneous clip space to (u, v, z) of an image: u, v from 0 to 1 over it, v = 0 at its first row, z
    as the depth buffer has it."""
    _check(depth, first_row)
    down = y_up == (first_row == "top")  # v grows against y
    half = depth == "-1..1"
    return np.array([[0.5, 0, 0, 0.5], [0, -0.5 if down else 0.5, 0, 0.5],
                     [0, 0, 0.5 if half else 1, 0.5 if half else 0], [0, 0, 0, 1.0]])


def camera_from_view_projection(view_projection: ArrayLike, depth: str = "-1..1", y_up: bool = True,
                                **fields: Any) -> Camera:
    """The camera of a G-buffer whose depth image is what the depth buffer holds and whose first row is the
    top one.

    The position is where the projection puts it: on the line through the middle of the picture for a
    parallel one.
    """
    m = _matrix(view_projection, "view_projection")
    _check(depth, "top")
    # Pellucid's clip space: y up, z as in the depth image.
    to_pellucid = np.diag([1.0, 1.0 if y_up else -1.0, 1.0, 1.0])
    if depth == "-1..1":
        to_pellucid[2, 2:] = 0.5, 0.5
    clip = to_pellucid @ m
    try:
        inverse = np.linalg.inv(clip)
    except np.linalg.LinAlgError:
        raise ValueError("view_projection has no inverse") from None
    # The eye is what x = y = w = 0 holds.
    eye = np.linalg.svd(clip[[0, 1, 3]])[2][3]
    near = abs(eye[3]) > 1e-12 * np.abs(eye[:3]).max()
    place = eye[:3] / eye[3] if near else -1e6 * eye[:3] / np.linalg.norm(eye[:3])
    return Camera(position=place, inverse_view_projection=inverse, **fields)


def light_from_view_projection(view_projection: ArrayLike, depth: str = "-1..1", y_up: bool = True,
                               first_row: str = "top", **fields: Any) -> Light:
    """A light whose shadow map was drawn with this matrix: directional for a parallel projection, a spot for
    a perspective one.

    `fields` are others of Light, such as `color`. For a spot, `spot_cos_inner` and `spot_cos_outer` are left
    to the caller.
    """
    m = _matrix(view_projection, "view_projection")
    matrix = clip_to_image(depth, y_up, first_row) @ m
    light = Light(world_to_shadow=matrix, **fields)
    if np.abs(m[3, :3]).max() <= 1e-12 * np.abs(m[:3, :3]).max():  # parallel
        matrix = matrix / m[3, 3]
        light.world_to_shadow = matrix
        length = np.linalg.norm(matrix[2, :3])
        if length == 0:
            raise ValueError("view_projection makes no depth")
        # z grows along this row (or against it: reversed), by 1 over depth_range.
        sign = -1.0 if depth == "1..0" else 1.0
        light.to_light = -sign * matrix[2, :3] / length
        light.shadow_projection = ShadowProjection.PARALLEL
        light.shadow_depth_range = sign / length
        return light
    # Along the view axis the distance is w (its gradient scaled to 1), and z = (a + b w) / w.
    axis = matrix[3, :3]
    scale = np.linalg.norm(axis)
    slope = matrix[2, :3] @ axis / scale**2
    offset = matrix[2, 3] - slope * matrix[3, 3]  # z w = slope w + offset
    if offset == 0:
        raise ValueError("view_projection makes no depth")
    eye = np.linalg.svd(np.array([matrix[0] - 0.5 * matrix[3], matrix[1] - 0.5 * matrix[3], matrix[3]]))[2][3]
    light.type = "spot"  # type: ignore[assignment]
    light.position = eye[:3] / eye[3]
    light.spot_direction = axis / scale
    light.shadow_projection = ShadowProjection.PERSPECTIVE
    # distance = w / scale = 1 / (A z + B); z = slope + offset / w, so 1 / w = (z - slope) / offset.
    light.shadow_depth_a = scale / offset
    light.shadow_depth_b = -scale * slope / offset
    return light
