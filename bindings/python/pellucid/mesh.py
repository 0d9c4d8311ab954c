"""Curvature, orientation and UV scale of meshes, curvature of meshes that move in part, and of pictures."""
from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _in_flight, _native
from ._arrays import Vertices, View, address, output_array, submit, to_image, vertex_view
from ._struct import OfThisProcess, to_enum
from ._types import (
    CurvatureEstimator,
    CurvatureParams,
    CurvatureQuantity,
    LiveMeshStats,
    MeshOrientation,
    MeshReport,
    ScreenCurvatureParams,
    SmoothingWeights,
    Weld,
)
from .device import Device, Event, _filled


class MeshTopology(OfThisProcess):
    """The connectivity of a mesh, analysed once; curvature for any positions then reuses it.

    Parameters
    ----------
    device : Device
    indices : (t, 3) or (3 t,) integers
        Three per triangle. Read during the call; other types and layouts than packed uint32 are converted.
    num_vertices : int, optional
        Needed without `positions`.
    weld : Weld or str
        "none", "exact" or "tolerance": vertices at the same place are one vertex to the topology.
    positions : (n, 3) float32, optional
        Needed when welding; read during the call.
    weld_tolerance : float
        Length, with weld="tolerance".

    Attributes
    ----------
    report : MeshReport
        What was found in the mesh.

    Raises
    ------
    PellucidError
        An index count that is no multiple of 3, or an index out of range (the message names the triangle).
    """

    _instead = "pass what save() gives to MeshTopology.load there"

    def __init__(self, device: Device, indices: ArrayLike, num_vertices: Optional[int] = None, *,
                 weld: Weld | str = Weld.NONE, positions: Optional[NDArray[np.float32]] = None,
                 weld_tolerance: float = 0.0) -> None:
        packed, held, stride, self.num_vertices = _triangles(indices, num_vertices, positions)
        self.device = device
        self.report = MeshReport()
        self._handle = _native.MeshTopology.create(device._handle, self.num_vertices, packed.ctypes.data,
                                                   packed.size,
                                                   int(to_enum(Weld, weld, "weld")), weld_tolerance,
                                                   address(held), stride, self.report._data)

    @classmethod
    def load(cls, device: Device, data: bytes | bytearray | memoryview) -> MeshTopology:
        """A topology from the bytes of `save`, without a new analysis.

        Raises
        ------
        PellucidError
            Data that is damaged, or of another version of the library.
        """
        self = cls.__new__(cls)
        self.device, self.report = device, MeshReport()
        packed = bytes(data)
        self._handle = _native.MeshTopology.load(device._handle, packed, self.report._data)
        self.num_vertices = int(self.report.vertices)
        return self

    def save(self) -> bytes:
        """The analysis as bytes, for machines of the same byte order and this version of the library."""
        return self._handle.save()

    def normals(self, positions: Any, out: Optional[NDArray[np.float32]] = None) -> NDArray[np.float32]:
        """Unit normals from positions: those of a vertex's triangles, weighted by their angles there.

        Vertices that were welded share one; (0, 0, 0) where no triangle has a plane.

        Parameters
        ----------
        positions : (n, 3) float32
            Any positive row stride, in place; or Vertices of a Buffer.
        out : (n, 3) float32, optional
            Where the result goes; a new array without it.
        """
        shape = (self.num_vertices, 3)
        result = out if isinstance(out, Vertices) else output_array(out, shape, np.float32, "out")
        self.submit_normals(positions, result).wait()
        return result

    def submit_normals(self, positions: Any, out: Any, *, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
        views = [vertex_view(self.device, positions, 3, "positions"),
                 vertex_view(self.device, out, 3, "out", output=True)]
        return submit(self.device, views, waits, self._handle.normals, self)

    def curvature(self, positions: Any, normals: Any = None, out: Optional[NDArray[np.float32]] = None, *,
                  params: Optional[CurvatureParams] = None, estimator: CurvatureEstimator | str | None = None,
                  quantity: CurvatureQuantity | str | None = None, smoothing_passes: Optional[int] = None,
                  smoothing_radius: Optional[float] = None,
                  smoothing_weights: SmoothingWeights | str | None = None,
                  scale: Optional[float] = None, report: bool = False) -> NDArray[np.float32]:
        """Curvature at each vertex, in 1/length, finite; 0 where nothing could be measured.

        Parameters
        ----------
        positions, normals : (n, 3) float32
            Any positive row stride, in place; or Vertices of a Buffer. Normals are of unit length; None:
            they are made from the positions.
        out : (n,) float32, optional
            Where the result goes, any positive stride; a new array without it. (n, 2) for the quantity
            "principal", (n, 8) for "frame".
        params : CurvatureParams, optional
        estimator, quantity, smoothing_passes, smoothing_radius, smoothing_weights, scale
            Fields of it by themselves.
        report : bool
            Also count in `self.report` the elements that were skipped because of these positions and normals.
        """
        settings = _settings(params, estimator=estimator, quantity=quantity,
                             smoothing_passes=smoothing_passes,
                             smoothing_radius=smoothing_radius, smoothing_weights=smoothing_weights,
                             scale=scale)
        result = out if isinstance(
            out, Vertices) else output_array(out, _shape(self.num_vertices, settings), np.float32, "out")
        found = MeshReport() if report else None
        self._submit(positions, normals, result, settings, found, ()).wait()
        if found is not None:
            self.report = found
        return result

    def submit_curvature(self, positions: Any, normals: Any, out: Any, *,
                         params: Optional[CurvatureParams] = None,
                         estimator: CurvatureEstimator | str | None = None,
                         quantity: CurvatureQuantity | str | None = None,
                         smoothing_passes: Optional[int] = None, smoothing_radius: Optional[float] = None,
                         smoothing_weights: SmoothingWeights | str | None = None,
                         scale: Optional[float] = None, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
        settings = _settings(params, estimator=estimator, quantity=quantity,
                             smoothing_passes=smoothing_passes,
                             smoothing_radius=smoothing_radius, smoothing_weights=smoothing_weights,
                             scale=scale)
        return self._submit(positions, normals, out, settings, None, waits)

    def _submit(self, positions: Any, normals: Any, out: Any, params: CurvatureParams,
                report: Optional[MeshReport], waits: Iterable[Event]) -> Event:
        views = [vertex_view(self.device, positions, 3, "positions"),
                 None if normals is None else vertex_view(self.device, normals, 3, "normals"),
                 vertex_view(self.device, out, _COMPONENTS.get(params.quantity, 1), "out", output=True)]

        def enqueue(p: Any, n: Any, c: Any, w: list[_native.Event]) -> Any:
            def work() -> Any:
                return self._handle.curvature(params._data, p, n, c, report and report._data, w)

            # A report is waited for.
            return work() if report is None else _in_flight.interruptible(work, views, report)

        return submit(self.device, views, waits, enqueue, self)

    def uv_scale(self, positions: Any, uvs: Any) -> float:
        """Geometric mean over triangles of longest edge / longest UV edge, in length per UV unit.

        Parameters
        ----------
        positions : (n, 3) float32
        uvs : (n, 2) float32

        Raises
        ------
        PellucidError
            No triangle is large enough to measure.
        """
        views = [vertex_view(self.device, positions, 3, "positions"), vertex_view(self.device, uvs, 2, "uvs")]
        scale: list[float] = []

        def measure(p: Any, u: Any, _: Any) -> None:
            scale.append(_in_flight.interruptible(lambda: self._handle.uv_scale(p, u), views))

        submit(self.device, views, [], measure)
        return scale[0]


def orient_mesh(indices: ArrayLike, num_vertices: Optional[int] = None, *,
                positions: Optional[NDArray[np.float32]] = None,
                normals: Optional[NDArray[np.float32]] = None, weld: Weld | str = Weld.NONE,
                weld_tolerance: float = 0.0) -> tuple[NDArray[np.uint32], MeshOrientation]:
    """Flips triangles so that the two triangles of every edge traverse it in opposite directions.

    Consistent parts do not change. For other parts the outward side is the side that `normals` point to. If
    normals do not decide, it is the outside of a closed part with positions, and otherwise that of the
    majority of triangles. Nothing else in this package flips triangles.

    Parameters
    ----------
    indices : (t, 3) or (3 t,) integers
        Three per triangle.
    num_vertices : int, optional
        Needed without `positions`.
    positions : (n, 3) float32, optional
    normals : (n, 3) float32, optional
        Only with positions.
    weld, weld_tolerance
        As in MeshTopology.

    Returns
    -------
    oriented : uint32, of the shape of indices
        A new array; the second and third index of some triangles have changed places.
    found : MeshOrientation
        Counts of flipped triangles and of edges that are still inconsistent.
    """
    packed, held, stride, count = _triangles(indices, num_vertices, positions)
    oriented = packed.copy()
    given, normal_stride = (None, 0) if normals is None else _rows(normals, "normals", count)
    found = MeshOrientation()
    kind = int(to_enum(Weld, weld, "weld"))
    _in_flight.interruptible(lambda: _native.orient_mesh(
        count, oriented.ctypes.data, oriented.size, kind, weld_tolerance, address(held), stride,
        address(given), normal_stride, found._data), oriented, held, given, found)
    return oriented, found


def _rows(array: NDArray[np.float32], name: str, count: Optional[int]) -> tuple[NDArray[np.float32], int]:
    """(n, 3) float32 whose components follow one another, and the bytes from row to row."""
    if array.dtype != np.float32 or array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} are {array.dtype} of shape {array.shape}; they must be float32, (n, 3)")
    if count is not None and count != len(array):
        raise ValueError(f"there are {count} vertices and {name} has {len(array)} rows")
    if len(array) > 1 and (array.strides[1] != 4 or array.strides[0] <= 0):
        array = np.ascontiguousarray(array)
    return array, array.strides[0] if len(array) > 1 else 12


def _triangles(indices: ArrayLike, num_vertices: Optional[int], positions: Optional[NDArray[np.float32]]
               ) -> tuple[NDArray[np.uint32], Optional[NDArray[np.float32]], int, int]:
    """Packed indices, positions in place with the bytes from row to row, and the number of vertices."""
    triangles = np.asarray(indices)
    if triangles.size and (triangles.dtype.kind not in "ui" or
                           (triangles.dtype != np.uint32
                            and not 0 <= triangles.min() <= triangles.max() < 2**32)):
        raise ValueError(f"indices are {triangles.dtype} from {triangles.min()} to {triangles.max()}; "
                         f"integers from 0 " "are needed")
    stride = 0
    if positions is not None:
        positions, stride = _rows(positions, "positions", num_vertices)
        num_vertices = len(positions)
    if num_vertices is None:
        raise ValueError("num_vertices or positions is needed")
    if not 0 <= num_vertices < 2**32:
        raise ValueError(f"num_vertices is {num_vertices}; it must be from 0 to {2**32 - 1}")
    return np.ascontiguousarray(triangles, np.uint32), positions, stride, int(num_vertices)


# Floats per vertex of the quantities that have more than one.
_COMPONENTS = {CurvatureQuantity.PRINCIPAL: 2, CurvatureQuantity.FRAME: 8}


def _shape(vertices: int, params: CurvatureParams) -> tuple[int, ...]:
    return (vertices, _COMPONENTS[params.quantity]) if params.quantity in _COMPONENTS else (vertices,)


def _settings(params: Optional[CurvatureParams], **given: Any) -> CurvatureParams:
    return CurvatureParams._with(params, {name: v for name, v in given.items() if v is not None})


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
        """Writes the changed results to `out`, and waits; the same bits as measuring everything anew.

        Parameters
        ----------
        positions : (n, 3) float32
            Any positive row stride, in place; or Vertices of a Buffer.
        normals : (n, 3) float32 or None
            Likewise; None: they are made from the positions.
        out : (n,) float32
            1/length; (n, 2) for the quantity "principal", (n, 8) for "frame". Rows that the change does not
            affect are not written, so pass the same array each time.
        changed : iterable of (first, count), optional
            Ranges of vertices whose position or normal has changed since the last update; empty: none, and
            nothing is done; None: all.

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
        views = [vertex_view(device, positions, 3, "positions"),
                 None if normals is None else vertex_view(device, normals, 3, "normals"), self._target(out)]
        ranges = None
        if changed is not None:  # numbers beyond 32 bits become one that the library refuses
            given = np.array(list(changed), np.int64).reshape(-1, 2)
            ranges = np.minimum(given.view(np.uint64), 2**32 - 1).astype(np.uint32)
        count = 0 if ranges is None else len(ranges)
        return submit(device, views, waits,
                      lambda p, n, c, w: self._handle.update(p, n, c, address(ranges), count, w),
                      self, ranges)

    def _target(self, out: Any) -> View:
        """The view of `out`, with the same buffer for the same array: another would be written in full."""
        key = (out.ctypes.data, out.shape, out.strides, out.dtype) if isinstance(out, np.ndarray) else None
        if key is not None and self._out is not None and self._out[0] == key:
            return self._out[1]
        view = vertex_view(self.topology.device, out, _COMPONENTS.get(self.params.quantity, 1), "out",
                           output=True)
        self._out = None if key is None else (key, view)
        return view

    def stats(self) -> LiveMeshStats:
        """Statistics of the last update."""
        return _filled(LiveMeshStats, self._handle.stats())


def screen_curvature(device: Device, normals: Any, positions: Any = None, *, depth: Any = None,
                     ids: Any = None, out: Optional[NDArray[np.float32]] = None,
                     params: Optional[ScreenCurvatureParams] = None) -> NDArray[np.float32]:
    """Curvature per pixel of a G-buffer, |fwidth N| / |fwidth P|, 1/length, finite; see pelScreenCurvature.

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
    return submit(device, images, waits,
                  lambda *given: _native.screen_curvature(device._handle, settings._data, *given))
