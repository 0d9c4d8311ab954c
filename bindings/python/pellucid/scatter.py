"""Scattering alone: on the screen, for hosts that light their own frames; in the texture of a mesh; and by
the surface integral, which every diffusion method approximates."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _in_flight, _native
from ._arrays import Image, address, submit, to_image, vertex_view
from ._struct import OfThisProcess, to_enum
from ._types import (
    ImageSlot,
    IrradianceAt,
    ScatterControls,
    ScatterParams,
    ScatterStats,
    TextureScatterParams,
    TextureScatterStats,
)
from .device import Device, Event, _filled
from .mesh import _triangles
from .profile import Profile, as_profile


class Scatter(OfThisProcess):
    """Scatters a picture's irradiance under the surface (pelScatterExecute); keeps memory between frames."""

    _instead = "make one there"

    def __init__(self, device: Device) -> None:
        self.device = device
        self._handle = _native.Scatter.create(device._handle)
        self._images: dict[ImageSlot, Image] = {}

    def set_material(self, id: int, profile: Profile | str | None, scale: float = 1.0) -> None:
        """Pixels of `id`, 1 to 255, scatter by `profile` (or the material of the library of that name),
        whose lengths count `scale` units of positions each; None: not at all."""
        known = as_profile(profile)
        self._handle.set_material(id, None if known is None else known._handle, scale)

    def set_controls(self, id: int, controls: Optional[ScatterControls] = None, **fields: Any) -> None:
        """How pixels of `id`, whose material is set, scatter: `controls` (or the defaults) with `fields`."""
        self._handle.set_controls(id, ScatterControls._with(controls, fields)._data)

    def set_image(self, slot: ImageSlot | str, image: Any) -> None:
        """Sets a further image that executions read: "scatter_weight", "irradiance_back", "albedo",
        "normal_geometric" or "mean_curvature"; None clears it. The image stays the caller's, and is read at
        each execution. Either of the last two turns on the gain of curved bodies."""
        s = to_enum(ImageSlot, slot, "slot")
        image = to_image(self.device, image, s.name.lower())
        self._handle.set_image(int(s), None if image is None else image._view.native)
        if image is None:
            self._images.pop(s, None)
        else:
            self._images[s] = image

    def execute(self, irradiance: Any, positions: Any = None, *, depth: Any = None, ids: Any = None,
                out: Optional[NDArray[np.float32]] = None,
                params: Optional[ScatterParams] = None) -> NDArray[np.float32]:
        """Scattered irradiance.

        Parameters
        ----------
        irradiance : (height, width, 3)
            All lights together, shadows sharp, in any layout that Image takes.
        positions : (height, width, 3)
            World.
        depth : (height, width), optional
            Instead of positions, with params.inverse_view_projection.
        ids : (height, width) unsigned integers, optional
            Of materials; no light flows from one to another; 0 is background. None: all pixels are 1.
        out : (height, width, 3) float32, optional
            A new array without it; may be the irradiance.
        params : ScatterParams, optional
        """
        result = np.empty(np.shape(irradiance), np.float32) if out is None else out
        self.submit_execute(irradiance, positions, result, depth=depth, ids=ids, params=params).wait()
        return result

    def warm_up(self, irradiance: Any, positions: Any = None, out: Any = None, *, depth: Any = None,
                ids: Any = None, params: Optional[ScatterParams] = None) -> int:
        """Builds the OpenCL programs of such an `execute` before it; only the formats and packing of the
        images matter. See warm_up_programs. Returns how many programs were not there before."""
        target = np.empty(np.shape(irradiance), np.float32) if out is None else out
        settings, images = self._arguments(irradiance, positions, target, depth, ids, params)
        given = [None if image is None else image._view.native for image in images]
        return int(_in_flight.interruptible(
            lambda: self._handle.warm_up(self.device._handle, settings._data, *given), *images))

    def _arguments(self, irradiance: Any, positions: Any, out: Any, depth: Any, ids: Any,
                   params: Optional[ScatterParams]) -> tuple[ScatterParams, list[Optional[Image]]]:
        target = to_image(self.device, out, "out", output=True)
        return ScatterParams() if params is None else params, [
            target if out is irradiance else to_image(self.device, irradiance, "irradiance"),
            to_image(self.device, positions, "positions"), to_image(self.device, depth, "depth"),
            to_image(self.device, ids, "ids", ids=True), target]

    def submit_execute(self, irradiance: Any, positions: Any, out: Any, *, depth: Any = None, ids: Any = None,
                       params: Optional[ScatterParams] = None, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
        settings, images = self._arguments(irradiance, positions, out, depth, ids, params)
        return submit(self.device, images, waits, lambda *given: self._handle.execute(settings._data, *given),
                      self, moved=self._images.values())

    def stats(self) -> ScatterStats:
        """What the last execution did."""
        return _filled(ScatterStats, self._handle.stats())


class TextureScatter(OfThisProcess):
    """Irradiance of a mesh, drawn into its texture and scattered there; see pelTextureScatterExecute. Keeps
    memory between calls.

    Parameters
    ----------
    device : Device
    width, height : int
        Of the texture, texels.
    indices : (t, 3) or (3 t,) integers
        Three vertices per triangle.
    uvs : (n, 2) float32
        Texture coordinates per vertex, from 0 to 1.

    Raises
    ------
    PellucidError
        Indices out of range, coordinates that are not finite.
    """

    _instead = "make one there"

    def __init__(self, device: Device, width: int, height: int, indices: ArrayLike, uvs: ArrayLike) -> None:
        coordinates = np.ascontiguousarray(uvs, np.float32)
        if coordinates.ndim != 2 or coordinates.shape[1] != 2:
            raise ValueError(f"uvs have the shape {coordinates.shape}; (n, 2) is needed")
        packed = _triangles(indices, len(coordinates), None)[0]
        self.device, self.width, self.height = device, width, height
        self._handle = _native.TextureScatter.create(device._handle, width, height, len(coordinates),
                                                     packed.ctypes.data, packed.size, coordinates.ctypes.data)

    def set_positions(self, positions: Any) -> None:
        """Where the vertices are, (n, 3) float32: before anything else, and again when the mesh moved."""
        self.submit_set_positions(positions).wait()

    def submit_set_positions(self, positions: Any, *, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting."""
        view = vertex_view(self.device, positions, 3, "positions")
        return submit(self.device, [view], waits, self._handle.set_positions, self)

    def draw(self, values: Any, out: Optional[NDArray[np.float32]] = None, *,
             unit: bool = False) -> NDArray[np.float32]:
        """Values per vertex, (n, 3) float32, drawn into the texture, (height, width, 3); `unit`: normals."""
        result = np.empty((self.height, self.width, 3), np.float32) if out is None else out
        self.submit_draw(values, result, unit=unit).wait()
        return result

    def submit_draw(self, values: Any, out: Any, *, unit: bool = False, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
        view = vertex_view(self.device, values, 3, "values")
        image = to_image(self.device, out, "out", output=True)
        return submit(self.device, [view, image], waits,
                      lambda v, i, w: self._handle.draw(v, unit, i, w), self)

    def execute(self, irradiance: Any, albedo: Any = None, *, out: Optional[NDArray[np.float32]] = None,
                params: Optional[TextureScatterParams] = None) -> NDArray[np.float32]:
        """Scattered irradiance, (height, width, 3).

        Parameters
        ----------
        irradiance : (height, width, 3)
            The host's own, or drawn; only texels in triangles count.
        albedo : (height, width, 3), optional
            With params.albedo_before or albedo_after.
        out : (height, width, 3) float32, optional
            A new array without it; may be the irradiance.
        params : TextureScatterParams, optional
        """
        result = np.empty((self.height, self.width, 3), np.float32) if out is None else out
        self.submit_execute(irradiance, albedo, result, params=params).wait()
        return result

    def submit_execute(self, irradiance: Any, albedo: Any, out: Any, *,
                       params: Optional[TextureScatterParams] = None, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
        settings = TextureScatterParams() if params is None else params
        target = to_image(self.device, out, "out", output=True)
        images = [target if out is irradiance else to_image(self.device, irradiance, "irradiance"),
                  to_image(self.device, albedo, "albedo"), target]
        return submit(self.device, images, waits, lambda *given: self._handle.execute(settings._data, *given),
                      self)

    def stats(self) -> TextureScatterStats:
        """What the last execution did."""
        return _filled(TextureScatterStats, self._handle.stats())


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
    e = np.ascontiguousarray(irradiance, np.float32)
    if p.ndim != 2 or p.shape[1] != 3:
        raise ValueError(f"positions has shape {p.shape}; (n, 3) is needed")
    t = _triangles(triangles, len(p), None)[0].reshape(-1, 3)
    places = {(len(t), 3): IrradianceAt.TRIANGLE, (len(t), 3, 3): IrradianceAt.CORNER,
              (len(p), 3): IrradianceAt.VERTEX}  # the last counts where there are as many of both
    if e.shape not in places:
        raise ValueError(f"irradiance has shape {e.shape}; it must be one of {', '.join(map(str, places))}")
    at = places[e.shape]
    views = [vertex_view(device, points, 3, "points"), vertex_view(device, out, 3, "out", output=True)]
    known = as_profile(profile)
    handle = None if known is None else known._handle
    return submit(device, views, waits, lambda *given: _native.surface_integral(
        device._handle, p.ctypes.data, len(p), t.ctypes.data, t.size, e.ctypes.data, int(at), handle,
        diffusion_radius, millimetres_per_unit, list(cut), tolerance, *given))


def _pictures(a: Any, b: Any) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    one, two = (np.ascontiguousarray(x, np.float32) for x in (a, b))
    if one.shape != two.shape or one.ndim < 1 or one.shape[-1] != 3:
        raise ValueError(f"a has shape {one.shape}, b {two.shape}; both need the same, ending in 3 channels")
    return one, two


def compare(a: Any, b: Any, mask: Any = None) -> dict[str, Any]:
    """The difference of two pictures of linear RGB.

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
    one, two = _pictures(a, b)
    within = None if mask is None else np.ascontiguousarray(np.asarray(mask) != 0, np.uint8)
    if within is not None and within.shape != one.shape[:-1]:
        raise ValueError(f"mask has shape {within.shape}; {one.shape[:-1]} is needed")
    return _in_flight.interruptible(lambda: _native.compare_images(
        address(one), address(two), one.size // 3, address(within)), one, two, within)


def flip(a: Any, b: Any) -> float:
    """How visible the difference of two pictures is: the mean of LDR-FLIP [Andersson et al. 2020] at
    67 pixels per degree, 0 (none) to 1.

    Parameters
    ----------
    a, b : (height, width, 3) floats
        Linear RGB, cut at 0 and 1. A NaN makes the result NaN.
    """
    one, two = _pictures(a, b)
    if one.ndim != 3 or one.size == 0:
        raise ValueError(f"the pictures have shape {one.shape}; (height, width, 3) is needed")
    return _in_flight.interruptible(
        lambda: _native.flip(one.ctypes.data, two.ctypes.data, one.size, one.shape[1]), one, two)
