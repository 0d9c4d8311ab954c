"""Curvature of meshes of which a part moves, and of pictures."""
from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arrays import View, natives, submit, to_image, vertex_view
from ._struct import OfThisProcess
from ._types import CurvatureParams, LiveMeshStats, ScreenCurvatureParams
from .device import Device, Event, _filled, _handles
from .mesh import _COMPONENTS, MeshTopology


class LiveMesh(OfThisProcess):
    """Curvature of a mesh of which a part moves from update to update; see pelLiveMeshUpdate.

    Parameters
    ----------
    topology : MeshTopology
    params : CurvatureParams, optional
        How curvature is measured and smoothed, for all updates.
    """

    _instead = "make one there from a topology"

    def __init__(self, topology: MeshTopology, params: Optional[CurvatureParams] = None) -> None:
        self.topology = topology
        self.params = CurvatureParams() if params is None else params.copy()
        self._handle = _native.LiveMesh.create(topology._handle, self.params._data)
        self._out: Optional[tuple[Any, View]] = None

    def update(self, positions: Any, normals: Any, out: Any,
               changed: Optional[Iterable[tuple[int, int]]] = None) -> None:
        """Writes to `out` what the change asks for, and waits; the same bits as measuring everything anew.

        Parameters
        ----------
        positions : (n, 3) float32
            Any positive row stride, in place; or Vertices of a Buffer.
        normals : (n, 3) float32 or None
            Likewise; None: they are made from the positions.
        out : (n,) float32
            1/length; (n, 2) for the quantity "principal", (n, 8) for "frame". Rows that the change does not
            reach are left alone, so pass the same one each time.
        changed : iterable of (first, count), optional
            Ranges of vertices that moved or turned since the update before; empty: none did, and nothing is
            done; None: all.

        Raises
        ------
        PellucidError
            A range that leaves the mesh.
        """
        self.submit_update(positions, normals, out, changed).wait()

    def submit_update(self, positions: Any, normals: Any, out: Any,
                      changed: Optional[Iterable[tuple[int, int]]] = None, *,
                      waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
        device = self.topology.device
        p = vertex_view(device, positions, 3, "positions")
        n = None if normals is None else vertex_view(device, normals, 3, "normals")
        c = self._target(out)
        ranges = None if changed is None else np.array(list(changed), np.uint32).reshape(-1, 2)
        views = [v for v in (p, n, c) if v is not None]
        given = [*natives([p, n, c]), *((0, 0) if ranges is None else (ranges.ctypes.data, len(ranges)))]
        return Event(submit(device, views, _handles(waits), lambda w: self._handle.update(*given, w), self,
                            ranges))

    def _target(self, out: Any) -> View:
        """The view of `out`, the same buffer again for the same array: another one would be written whole."""
        key = (out.ctypes.data, out.shape, out.strides, out.dtype) if isinstance(out, np.ndarray) else None
        if key is not None and self._out is not None and self._out[0] == key:
            return self._out[1]
        view = vertex_view(self.topology.device, out, _COMPONENTS.get(self.params.quantity, 1), "out",
                           output=True)
        self._out = None if key is None else (key, view)
        return view

    def stats(self) -> LiveMeshStats:
        """What the last update did."""
        return _filled(LiveMeshStats, self._handle.stats())


def screen_curvature(device: Device, normals: Any, positions: Any = None, *, depth: Any = None,
                     ids: Any = None, out: Optional[NDArray[np.float32]] = None,
                     params: Optional[ScreenCurvatureParams] = None) -> NDArray[np.float32]:
    """Curvature per pixel of a G-buffer, |fwidth N| / |fwidth P|, in 1/length, finite; see
    pelScreenCurvature.

    Parameters
    ----------
    normals, positions : (height, width, 3)
        World, in any layout that Image takes.
    depth : (height, width), optional
        Instead of positions, with params.inverse_view_projection.
    ids : (height, width) unsigned integers, optional
        Differences never cross from one id to another; 0 is background.
    out : (height, width) float32, optional
        A new array without it.
    params : ScreenCurvatureParams, optional
    """
    result = np.empty(np.shape(normals)[:2], np.float32) if out is None else out
    submit_screen_curvature(device, normals, positions, result, depth=depth, ids=ids, params=params).wait()
    return result


def submit_screen_curvature(device: Device, normals: Any, positions: Any, out: Any, *, depth: Any = None,
                            ids: Any = None, params: Optional[ScreenCurvatureParams] = None,
                            waits: Iterable[Event] = ()) -> Event:
    """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
    settings = ScreenCurvatureParams() if params is None else params
    images = [to_image(device, normals, "normals"), to_image(device, positions, "positions"),
              to_image(device, depth, "depth"), to_image(device, ids, "ids", ids=True),
              to_image(device, out, "out", output=True)]
    given = natives(images)
    return Event(submit(device, [x._view for x in images if x is not None], _handles(waits),
                        lambda w: _native.screen_curvature(device._handle, settings._data, *given, w)))
