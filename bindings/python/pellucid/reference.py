"""What a picture should be: the surface integral, which every diffusion method approximates."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import submit, vertex_view
from ._types import IrradianceAt
from .device import Device, Event, _handles
from .profile import Profile, as_profile


def surface_integral(device: Device, positions: Any, triangles: Any, irradiance: Any, points: Any,
                     out: Optional[NDArray[np.float32]] = None, *, profile: Profile | str | None = None,
                     diffusion_radius: float = 0.0,
                     millimetres_per_unit: float = 1.0, cut: Sequence[float] = (0.0, 0.0, 0.0),
                     tolerance: float = 1e-3) -> NDArray[np.float32]:
    """Light that leaves a surface after diffusing under it: sum over the mesh of R(distance) irradiance; see
    pelSurfaceIntegral.

    Parameters
    ----------
    positions : (n, 3) float32
    triangles : (m, 3) integers
    irradiance : (n, 3), (m, 3) or (m, 3, 3) float32
        RGB per vertex, per triangle (where n is not m), or per corner of each triangle. 0 or more,
        visibility in it.
    points : (k, 3) float32
        Where; on the triangles.
    out : (k, 3) float32, optional
        A new array without it.
    profile : Profile or name of one of the library, optional
        Skin without it.
    diffusion_radius : float
        In the profile's unit; 0: its own.
    millimetres_per_unit : float
        Units of the profile per unit of positions.
    cut : three floats
        Where R ends, per channel, in the profile's unit; 0: nowhere.
    tolerance : float
        Error of the hierarchy, part of the largest irradiance.
    """
    result = np.empty(np.shape(points), np.float32) if out is None else out
    submit_surface_integral(device, positions, triangles, irradiance, points, result, profile=profile,
                            diffusion_radius=diffusion_radius, millimetres_per_unit=millimetres_per_unit,
                            cut=cut, tolerance=tolerance).wait()
    return result


def submit_surface_integral(device: Device, positions: Any, triangles: Any, irradiance: Any, points: Any,
                            out: Any, *, profile: Profile | str | None = None, diffusion_radius: float = 0.0,
                            millimetres_per_unit: float = 1.0, cut: Sequence[float] = (0.0, 0.0, 0.0),
                            tolerance: float = 1e-3, waits: Iterable[Event] = ()) -> Event:
    """The same after `waits`, without waiting: leave points and out alone until the event is done."""
    p = np.ascontiguousarray(positions, np.float32)
    t = np.asarray(triangles)
    e = np.ascontiguousarray(irradiance, np.float32)
    if p.ndim != 2 or p.shape[1] != 3:
        raise ValueError(f"positions has shape {p.shape}; (n, 3) is needed")
    if t.ndim != 2 or t.shape[1] != 3 or t.dtype.kind not in "iu":
        raise ValueError(f"triangles is {t.dtype} of shape {t.shape}; integers of shape (m, 3) are needed")
    if t.size and (t.min() < 0 or t.max() > 0xffffffff):
        raise ValueError("triangles holds indices that no vertex has")
    places = {(len(p), 3): IrradianceAt.VERTEX, (len(t), 3): IrradianceAt.TRIANGLE,
              (len(t), 3, 3): IrradianceAt.CORNER}
    if e.shape not in places:
        raise ValueError(f"irradiance has shape {e.shape}; it must be one of {', '.join(map(str, places))}")
    at = IrradianceAt.VERTEX if e.shape == (len(p), 3) else places[e.shape]
    t = np.ascontiguousarray(t, np.uint32)
    views = [vertex_view(device, points, 3, "points"), vertex_view(device, out, 3, "out", output=True)]
    x, s = (v.native for v in views)
    known = as_profile(profile)
    handle = None if known is None else known._handle
    return Event(submit(device, views, _handles(waits), lambda w: _native.surface_integral(
        device._handle, p.ctypes.data, len(p), t.ctypes.data, t.size, e.ctypes.data, int(at), handle,
        diffusion_radius, millimetres_per_unit, list(cut), tolerance, x, s, w)))


def compare(a: Any, b: Any, mask: Any = None) -> dict[str, Any]:
    """How far two pictures of linear RGB are apart.

    Parameters
    ----------
    a, b : (height, width, 3) floats
        Or (..., 3) of any shape; of one shape.
    mask : (height, width), optional
        Where it is 0 or False, pixels do not count.

    Returns
    -------
    dict
        pixels, invalid_pixels (with a NaN or Inf: left out), rmse, mean, p99 and max per channel (of a - b;
        the last two of its size), rmse_all, psnr in dB of a white of 1, and CIEDE2000 [Sharma et al. 2005]
        as delta_e_mean, delta_e_p99, delta_e_max. All but the counts are NaN when no pixel was compared.
    """
    one, two = (np.ascontiguousarray(x, np.float32) for x in (a, b))
    if one.shape != two.shape or one.ndim < 1 or one.shape[-1] != 3:
        raise ValueError(f"a has shape {one.shape}, b {two.shape}; both need the same, ending in 3 channels")
    within = None if mask is None else np.ascontiguousarray(np.asarray(mask) != 0, np.uint8)
    if within is not None and within.shape != one.shape[:-1]:
        raise ValueError(f"mask has shape {within.shape}; {one.shape[:-1]} is needed")
    return _native.compare_images(one.ctypes.data, two.ctypes.data, one.size // 3,
                                  0 if within is None else within.ctypes.data)
