"""Scattering in the texture of a mesh."""
from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import natives, submit, to_image, vertex_view
from ._struct import OfThisProcess
from ._types import TextureScatterParams, TextureScatterStats
from .device import Device, Event, _filled, _handles


class TextureScatter(OfThisProcess):
    """Irradiance of a mesh, drawn into its texture and scattered there; see pelTextureScatterExecute. Keeps
    memory between calls.

    Parameters
    ----------
    device : Device
    width, height : int
        Of the texture, texels.
    indices : (t, 3) integers
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
        triangles, coordinates = np.asarray(indices), np.ascontiguousarray(uvs, np.float32)
        if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu":
            raise ValueError(f"indices are {triangles.dtype} {triangles.shape}, not integers (t, 3)")
        if triangles.size and not 0 <= triangles.min() <= triangles.max() < 2**32:
            raise ValueError("indices hold numbers that no vertex has")
        if coordinates.ndim != 2 or coordinates.shape[1] != 2:
            raise ValueError(f"uvs have the shape {coordinates.shape}; (n, 2) is needed")
        packed = np.ascontiguousarray(triangles, np.uint32)
        self.device, self.width, self.height = device, width, height
        self._handle = _native.TextureScatter.create(device._handle, width, height, len(coordinates),
                                                     packed.ctypes.data, packed.size, coordinates.ctypes.data)

    def set_positions(self, positions: Any) -> None:
        """Where the vertices are, (n, 3) float32: before anything else, and again when the mesh moved."""
        self.submit_set_positions(positions).wait()

    def submit_set_positions(self, positions: Any, *, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting."""
        view = vertex_view(self.device, positions, 3, "positions")
        return Event(submit(self.device, [view], _handles(waits),
                            lambda w: self._handle.set_positions(view.native, w), self))

    def draw(self, values: Any, out: Optional[NDArray[np.float32]] = None, *,
             unit: bool = False) -> NDArray[np.float32]:
        """Values per vertex, (n, 3) float32, drawn into the texture, (height, width, 3); `unit`: they are
        normals."""
        result = np.empty((self.height, self.width, 3), np.float32) if out is None else out
        self.submit_draw(values, result, unit=unit).wait()
        return result

    def submit_draw(self, values: Any, out: Any, *, unit: bool = False, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
        view = vertex_view(self.device, values, 3, "values")
        image = to_image(self.device, out, "out", output=True)
        values_native, image_native = natives([view, image])
        return Event(submit(self.device, [view, image._view], _handles(waits),
                            lambda w: self._handle.draw(values_native, unit, image_native, w), self, image))

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
        given = natives(images)
        views = [x._view for x in images if x is not None]
        return Event(submit(self.device, views, _handles(waits),
                            lambda w: self._handle.execute(settings._data, *given, w), self))

    def stats(self) -> TextureScatterStats:
        """What the last execution did."""
        return _filled(TextureScatterStats, self._handle.stats())
