"""Curvature and UV scale of meshes."""
from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _flight, _native
from ._arrays import Vertices, output_array, submit, vertex_view
from ._struct import OfThisProcess, to_enum
from ._types import CurvatureEstimator, CurvatureParams, CurvatureQuantity, MeshReport, SmoothingWeights, Weld
from .device import Device, Event, _handles


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
        triangles = np.asarray(indices)
        if triangles.size and (triangles.dtype.kind not in "ui" or
                               (triangles.dtype != np.uint32 and not 0 <= triangles.min() <= triangles.max() < 2**32)):
            raise ValueError(f"indices are {triangles.dtype} from {triangles.min()} to {triangles.max()}; integers from 0 "
                             "are needed")
        packed = np.ascontiguousarray(triangles, np.uint32)
        address, stride = 0, 0
        if positions is not None:
            if positions.dtype != np.float32 or positions.ndim != 2 or positions.shape[1] != 3:
                raise ValueError(f"positions are {positions.dtype} of shape {positions.shape}; float32 of shape (n, 3) is "
                                 "needed")
            if len(positions) > 1 and (positions.strides[1] != 4 or positions.strides[0] <= 0):
                positions = np.ascontiguousarray(positions)
            address, stride = positions.ctypes.data, positions.strides[0] if len(positions) > 1 else 12
            if num_vertices not in (None, len(positions)):
                raise ValueError(f"num_vertices is {num_vertices} and positions has {len(positions)} rows")
            num_vertices = len(positions)
        if num_vertices is None:
            raise ValueError("num_vertices or positions is needed")
        if not 0 <= num_vertices < 2**32:
            raise ValueError(f"num_vertices is {num_vertices}; it must be from 0 to {2**32 - 1}")
        self.device = device
        self.num_vertices = int(num_vertices)
        self.report = MeshReport()
        with _flight.kept(device._handle, packed, positions):
            self._handle = _native.MeshTopology.create(device._handle, self.num_vertices, packed.ctypes.data, packed.size,
                                                       int(to_enum(Weld, weld, "weld")), weld_tolerance, address, stride,
                                                       self.report._data)

    @classmethod
    def load(cls, device: Device, data: bytes | bytearray | memoryview) -> MeshTopology:
        """A topology from what `save` gave, without analysing again.

        Raises
        ------
        PellucidError
            Data that is damaged, or of another version of the library.
        """
        self = cls.__new__(cls)
        self.device, self.report = device, MeshReport()
        packed = bytes(data)
        with _flight.kept(device._handle, packed):
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
        result = out if isinstance(out, Vertices) else output_array(out, (self.num_vertices, 3), np.float32, "out")
        self.submit_normals(positions, result).wait()
        return result

    def submit_normals(self, positions: Any, out: Any, *, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
        views = [vertex_view(self.device, positions, 3, "positions"), vertex_view(self.device, out, 3, "out", output=True)]
        p, n = (v.native for v in views)
        return Event(submit(self.device, views, _handles(waits), lambda w: self._handle.normals(p, n, w), self))

    def curvature(self, positions: Any, normals: Any = None, out: Optional[NDArray[np.float32]] = None, *,
                  params: Optional[CurvatureParams] = None, estimator: CurvatureEstimator | str | None = None,
                  quantity: CurvatureQuantity | str | None = None, smoothing_passes: Optional[int] = None,
                  smoothing_radius: Optional[float] = None, smoothing_weights: SmoothingWeights | str | None = None,
                  scale: Optional[float] = None, report: bool = False) -> NDArray[np.float32]:
        """Curvature at each vertex, in 1/length, finite; 0 where nothing could be measured.

        Parameters
        ----------
        positions, normals : (n, 3) float32
            Any positive row stride, in place; or Vertices of a Buffer. Normals are of unit length; None: they are made from the
            positions.
        out : (n,) float32, optional
            Where the result goes, any positive stride; a new array without it. (n, 2) for the quantity "principal", (n, 8)
            for "frame".
        params : CurvatureParams, optional
        estimator, quantity, smoothing_passes, smoothing_radius, smoothing_weights, scale
            Fields of it by themselves.
        report : bool
            Also count in `self.report` what these positions and normals made it skip.
        """
        settings = _settings(params, estimator=estimator, quantity=quantity, smoothing_passes=smoothing_passes,
                             smoothing_radius=smoothing_radius, smoothing_weights=smoothing_weights, scale=scale)
        result = out if isinstance(out, Vertices) else output_array(out, _shape(self.num_vertices, settings), np.float32, "out")
        found = MeshReport() if report else None
        self._submit(positions, normals, result, settings, found, ()).wait()
        if found is not None:
            self.report = found
        return result

    def submit_curvature(self, positions: Any, normals: Any, out: Any, *, params: Optional[CurvatureParams] = None,
                         estimator: CurvatureEstimator | str | None = None,
                         quantity: CurvatureQuantity | str | None = None, smoothing_passes: Optional[int] = None,
                         smoothing_radius: Optional[float] = None, smoothing_weights: SmoothingWeights | str | None = None,
                         scale: Optional[float] = None, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting: leave the arrays alone until the event is done."""
        settings = _settings(params, estimator=estimator, quantity=quantity, smoothing_passes=smoothing_passes,
                             smoothing_radius=smoothing_radius, smoothing_weights=smoothing_weights, scale=scale)
        return self._submit(positions, normals, out, settings, None, waits)

    def _submit(self, positions: Any, normals: Any, out: Any, params: CurvatureParams, report: Optional[MeshReport],
                waits: Iterable[Event]) -> Event:
        views = [vertex_view(self.device, positions, 3, "positions"),
                 vertex_view(self.device, out, _COMPONENTS.get(params.quantity, 1), "out", output=True)]
        p, c = (v.native for v in views)
        n = None
        if normals is not None:
            views.append(vertex_view(self.device, normals, 3, "normals"))
            n = views[-1].native
        return Event(submit(self.device, views, _handles(waits), lambda w: self._handle.curvature(
            params._data, p, n, c, None if report is None else report._data, w), self))

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
        p, u = (v.native for v in views)
        scale: list[float] = []
        submit(self.device, views, [], lambda waits: scale.append(self._handle.uv_scale(p, u)))
        return scale[0]


# Floats per vertex of the quantities that have more than one.
_COMPONENTS = {CurvatureQuantity.PRINCIPAL: 2, CurvatureQuantity.FRAME: 8}


def _shape(vertices: int, params: CurvatureParams) -> tuple[int, ...]:
    return (vertices, _COMPONENTS[params.quantity]) if params.quantity in _COMPONENTS else (vertices,)


def _settings(params: Optional[CurvatureParams], **given: Any) -> CurvatureParams:
    settings = CurvatureParams() if params is None else params.copy()
    for name, value in given.items():
        if value is not None:
            setattr(settings, name, value)
    return settings
