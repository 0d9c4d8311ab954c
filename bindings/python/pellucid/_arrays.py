"""NumPy arrays, PyOpenCL arrays and buffers as the views that the C interface takes, without copying."""
from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Optional

import numpy as np
from numpy.typing import DTypeLike, NDArray

from . import _in_flight, _native
from ._struct import to_enum
from ._types import Format
from .device import Buffer, Device, Event, _handles

# By type and number of components. One-component integers are ids in the material slot, else fractions.
_FORMATS = {
    ("float32", 1): Format.R32F, ("float32", 2): Format.RG32F, ("float32", 3): Format.RGB32F,
    ("float32", 4): Format.RGBA32F,
    ("float16", 1): Format.R16F, ("float16", 2): Format.RG16F, ("float16", 3): Format.RGB16F,
    ("float16", 4): Format.RGBA16F,
    ("uint8", 1): Format.R8_UNORM, ("uint8", 4): Format.RGBA8_UNORM, ("uint16", 1): Format.R16_UNORM,
    ("int16", 2): Format.OCT16X2_SNORM,
}
_ID_FORMATS = {"uint8": Format.R8_UINT, "uint16": Format.R16_UINT, "uint32": Format.R32_UINT}
# Storage of each named format: type and number of components.
_STORAGE = {f: key for key, f in _FORMATS.items()} | {f: (t, 1) for t, f in _ID_FORMATS.items()} | {
    Format.RGBA8_SRGB: ("uint8", 4), Format.A2B10G10R10_UNORM: ("uint32", 1),
    Format.PLANAR_RGB32F: ("float32", 3)}


def as_array(value: Any, what: str) -> NDArray[Any]:
    """An array over the memory of anything with the array, buffer or DLPack protocol; never a copy."""
    if isinstance(value, np.ndarray):
        return value
    if hasattr(value, "__dlpack__"):
        return np.from_dlpack(value)
    if hasattr(value, "__array_interface__") or isinstance(value, (memoryview, bytearray)):
        return np.asarray(value)
    raise TypeError(f"{what} is a {type(value).__name__}; a NumPy array, or an object with the buffer or "
                    "DLPack protocol, is needed")


def address(array: Optional[NDArray[Any]]) -> int:
    """Of an array's memory; 0 for None."""
    return 0 if array is None else array.ctypes.data


def _check_byte_order(dtype: np.dtype[Any], what: str) -> None:
    if not dtype.isnative:
        raise ValueError(f"{what} has the byte order of another machine ({dtype}: "
                         f"{'big' if dtype.byteorder == '>' else 'little'}-endian); "
                         "pass array.astype(array.dtype.newbyteorder('='))")


class Span:
    """The memory from an array's first to its last byte, as a buffer.

    On a CPU device that buffer is the memory itself. Elsewhere it has a twin on the device, and the bytes
    move with each submission: everything in before, the results out after.
    """

    def __init__(self, device: Device, array: NDArray[Any], what: str, output: bool) -> None:
        if array.size == 0:
            raise ValueError(f"{what} is empty: its shape is {array.shape}")
        least = min((s for n, s in zip(array.shape, array.strides) if n > 1), default=1)
        if least <= 0:
            problem = "has a negative stride" if least < 0 else "is broadcast (a stride of 0)"
            raise ValueError(f"{what} {problem}, which the device cannot follow; pass array.copy()")
        if output and not array.flags.writeable:
            raise ValueError(f"{what} is read-only and the result goes there")
        _check_byte_order(array.dtype, what)
        self.array, self.output = array, output
        self.address = array.ctypes.data
        self.nbytes = sum((n - 1) * s for n, s in zip(array.shape, array.strides)) + array.itemsize
        self.moves = not device._in_place
        if self.moves:
            self.handle = _native.Buffer.create(device._handle, self.nbytes, 0)
        else:
            self.handle = _native.Buffer.from_host(device._handle, self.address, self.nbytes)

    def upload(self, waits: list[_native.Event]) -> None:
        if self.moves:
            self.handle.write(0, self.nbytes, self.address, waits)

    def download(self) -> Optional[_native.Event]:
        return self.handle.read(0, self.nbytes, self.address, []) if self.moves and self.output else None


class View:
    """Part of a buffer, and what must stay alive and move for it."""

    def __init__(self, span: Span | Buffer, tail: tuple[int, ...]) -> None:
        self.span = span
        self._tail = tail

    @property
    def native(self) -> Any:
        handle = self.span.handle if isinstance(self.span, Span) else self.span._handle
        return (handle, *self._tail)


def _span(device: Device, memory: Buffer | NDArray[Any], what: str, output: bool) -> Span | Buffer:
    return memory if isinstance(memory, Buffer) else Span(device, memory, what, output)


def submit(device: Device, given: list[Any], waits: Iterable[Event], enqueue: Any, *used: Any,
           moved: Iterable[Image] = ()) -> Any:
    """Moves inputs, calls `enqueue(*given, waits)`, moves results; returns the event of the last step.

    None where the work was done inside `enqueue` and nothing moves back. `given`: views, images and None.
    `moved`: further images that the work uses. They and `used` live until the work is done.
    """
    given = [v._view if isinstance(v, Image) else v for v in given]
    views = [v for v in given if v is not None] + [image._view for image in moved]
    spans = {id(v.span): v.span for v in views if isinstance(v.span, Span)}.values()
    natives, handles = [None if v is None else v.native for v in given], _handles(waits)
    # Work in flight still reads and writes the arrays after an error or Ctrl-C.
    with _in_flight.kept(device._handle, views, used):
        for span in spans:
            span.upload(handles)
        done = enqueue(*natives, handles)
        for span in spans:
            done = span.download() or done
        if done is not None:
            _in_flight.hold(done, views, used)
    return None if done is None else Event(done)


def _memory(device: Device, value: Any,
            what: str) -> tuple[tuple[int, ...], tuple[int, ...], np.dtype[Any], int, Buffer | NDArray[Any]]:
    """Shape, strides, type, byte offset and memory of an array, or of a pyopencl.array.Array, whose package
    is not imported."""
    data = getattr(value, "base_data", None)
    if hasattr(data, "int_ptr"):
        return value.shape, value.strides, value.dtype, value.offset, Buffer.from_cl(device, data)
    array = as_array(value, what)
    return array.shape, array.strides, array.dtype, 0, array


class Vertices:
    """Vertex data inside a Buffer, for calls that take arrays of vertices.

    Parameters
    ----------
    buffer : Buffer
    count : int
        Vertices.
    byte_offset, byte_stride : int
        Multiples of 4; a stride of 0 is tightly packed.
    """

    def __init__(self, buffer: Buffer, count: int, byte_offset: int = 0, byte_stride: int = 0) -> None:
        self.buffer, self.count, self.byte_offset, self.byte_stride = buffer, count, byte_offset, byte_stride


def vertex_view(device: Device, value: Any, components: int, what: str, output: bool = False) -> View:
    """An array of float32 vertices: shape (n, components), or (n,) for one component; any positive strides.
    """
    if isinstance(value, Vertices):
        return View(value.buffer, (value.byte_offset, value.byte_stride, value.count))
    wanted = f"(n, {components})" if components > 1 else "(n,)"
    shape, strides, dtype, offset, memory = _memory(device, value, what)
    if dtype != np.float32:
        raise ValueError(f"{what} is {dtype}; float32 is needed, such as array.astype(numpy.float32)")
    if len(shape) != (2 if components > 1 else 1) or (components > 1 and shape[1] != components):
        raise ValueError(f"{what} has the shape {tuple(shape)}; {wanted} is needed")
    if components > 1 and strides[1] != 4:
        raise ValueError(f"{what} has components {strides[1]} bytes apart; they must follow each other "
                         "(numpy.ascontiguousarray makes a copy where they do)")
    # Arrays of one vertex or none have no meaningful stride, whatever NumPy says.
    stride = strides[0] if shape[0] > 1 else 4 * components
    if stride % 4:
        raise ValueError(f"{what} has vertices {stride} bytes apart; a multiple of 4 is needed")
    return View(_span(device, memory, what, output), (offset, stride, shape[0]))


class Image:
    """An image in the layout it already has, for the slots of a shader.

    Parameters
    ----------
    device : Device
    data : array, pyopencl.array.Array or Buffer
        An array of shape (height, width) or (height, width, components) with any positive strides is used in
        place, as long as its rows lie one after another: crops, every other pixel, part of the components,
        and three planes of float32. A Buffer needs `format`, `width` and `height`.
    format : Format or str, optional
        How the components are read. From the array without it: float32 and float16 with 1 to 4 components;
        uint8 with 1 or 4 as fractions of 255; uint16 with 1 as a fraction; int16 with 2 as an octahedral
        unit vector; one-component unsigned integers in the material slot as ids, and bool as 0 and 1.
    byte_offset, pixel_stride, row_stride, plane_stride : int
        Bytes, for a Buffer; strides of 0 are tightly packed.

    Raises
    ------
    ValueError
        No format fits; the message says what would.
    """

    def __init__(self, device: Device, data: Any, format: Format | str | None = None, *, width: int = 0,
                 height: int = 0, byte_offset: int = 0, pixel_stride: int = 0, row_stride: int = 0,
                 plane_stride: int = 0,
                 _slot: str = "the image", _output: bool = False, _ids: bool = False) -> None:
        self.format = None if format is None else to_enum(Format, format, "format")
        if isinstance(data, Buffer):
            if self.format is None or width <= 0 or height <= 0:
                raise ValueError(f"{_slot}: a Buffer needs format, width and height")
            self._view = View(data, (int(self.format), width, height, byte_offset, pixel_stride, row_stride,
                                     plane_stride))
            return
        if width or height or byte_offset or pixel_stride or row_stride or plane_stride:
            raise ValueError(f"{_slot}: size, offset and strides come from the array")
        shape, strides, dtype, byte_offset, memory = _memory(device, data, _slot)
        if _ids and dtype == np.bool_ and isinstance(memory, np.ndarray):  # material 1 where it is true
            memory, dtype = memory.view(np.uint8), np.dtype(np.uint8)
        _check_byte_order(dtype, _slot)
        if len(shape) not in (2, 3):
            raise ValueError(f"{_slot} has the shape {tuple(shape)}; (height, width) or (height, width, "
                             "components) is needed")
        components = shape[2] if len(shape) == 3 else 1
        between = strides[2] if len(shape) == 3 and components > 1 else dtype.itemsize
        planar = between != dtype.itemsize
        self.format = self._pick(dtype, components, planar, _ids, _slot)
        height, width = shape[:2]
        # Strides that NumPy leaves undefined for lengths of one.
        pixel = strides[1] if width > 1 else (dtype.itemsize if planar else components * dtype.itemsize)
        row = strides[0] if height > 1 else pixel * width
        if (height > 1 and 0 < row < pixel * width) or pixel % dtype.itemsize or row % dtype.itemsize:
            raise ValueError(f"{_slot} has pixels {pixel} bytes apart and rows {row}, which images cannot "
                             "have; pass numpy.ascontiguousarray(array)")
        tail = (int(self.format), width, height, byte_offset, pixel, row, between if planar else 0)
        self._view = View(_span(device, memory, _slot, _output), tail)

    def _pick(self, dtype: np.dtype[Any], components: int, planar: bool, ids: bool, slot: str) -> Format:
        if self.format is not None:
            stored = _STORAGE.get(self.format)
            if stored != (dtype.name, components):
                raise ValueError(f"{slot}: the format {self.format.name.lower()} is stored as "
                                 f"{stored and f'{stored[1]} x {stored[0]}'}, the array as {components} x "
                                 f"{dtype}")
            if planar != (self.format == Format.PLANAR_RGB32F) and components > 1:
                raise ValueError(f"{slot}: the components lie {'apart' if planar else 'together'}, which "
                                 f"{self.format.name.lower()} does not describe")
            return self.format
        if planar:
            if (dtype.name, components) == ("float32", 3):
                return Format.PLANAR_RGB32F
            raise ValueError(f"{slot} has components that lie apart; that works for three of float32 only, "
                             "else pass numpy.ascontiguousarray(array)")
        if ids and components == 1 and dtype.name in _ID_FORMATS:
            return _ID_FORMATS[dtype.name]
        if ids and dtype.kind in "iub":
            raise ValueError(f"{slot} has {components} components of {dtype}; ids are one of uint8, uint16 "
                             "or uint32 (array.astype(numpy.uint8) makes a copy that is)")
        found = _FORMATS.get((dtype.name, components))
        if found is None:
            raise ValueError(f"{slot} has {components} components of {dtype}, which no format stores; "
                             "float32 or float16 with 1 to 4, uint8 with 1 or 4, uint16 with 1 or int16 with "
                             "2 would do (array.astype(numpy.float32) makes a copy that is)")
        return found


def to_image(device: Device, value: Any, what: str, output: bool = False, ids: bool = False) -> Any:
    """`data` as an Image, unless it is one already; None for None."""
    if value is None or isinstance(value, Image):
        return value
    return Image(device, value, _slot=what, _output=output, _ids=ids)


def output_array(out: Optional[NDArray[Any]], shape: tuple[int, ...], dtype: DTypeLike,
                 what: str) -> NDArray[Any]:
    """`out`, checked, or a new array."""
    if out is None:
        return np.empty(shape, dtype)
    if out.shape != shape or out.dtype != np.dtype(dtype):
        raise ValueError(f"{what} is {out.dtype} of shape {out.shape}; it must be {np.dtype(dtype)}, {shape}")
    return out
