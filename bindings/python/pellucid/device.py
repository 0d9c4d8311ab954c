"""Devices, events and buffers."""
from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Generator, Iterable, Iterator
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import _in_flight, _native
from ._struct import OfThisProcess, S
from ._types import DeviceInfo, DeviceStats, DeviceType, LogLevel

Progress = Callable[[float, str], Optional[bool]]


def _cl_address(value: Any, what: str) -> int:
    """The OpenCL handle behind a PyOpenCL object or an integer."""
    address = getattr(value, "int_ptr", value)
    if not isinstance(address, int) or address == 0:
        raise TypeError(f"{what} is {value!r}; a PyOpenCL object or a handle as an integer is needed")
    return address


def _filled(kind: type[S], data: bytes) -> S:
    struct = kind()
    struct._data[0] = np.frombuffer(data, kind._dtype)[0]
    return struct


def devices() -> list[DeviceInfo]:
    """Describes every OpenCL device of this machine; the position in the list is a selector for `Device`."""
    return [_filled(DeviceInfo, data) for data in _native.devices()]


def set_error_callback(callback: Optional[Callable[[int, str], object]]) -> None:
    """Calls `callback(code, message)` with every error, on the failing thread. None removes it."""
    _native.set_error_callback(callback)


def set_log_callback(callback: Optional[Callable[[LogLevel, str, str], object]]) -> None:
    """Calls `callback(level, name, text)` with every error and every warning of a commit, on the thread of
    the call. `name`: of the first object of the call that has one (`set_name`). None removes it."""
    _native.set_log_callback(callback and (lambda level, name, text: callback(LogLevel(level), name, text)))


class Device(OfThisProcess):
    """An OpenCL device with a queue of its own.

    Parameters
    ----------
    selector : str or int
        A number in `devices()`; "gpu", "cpu" or "accelerator"; or a part of the name or platform. "": the
        environment variable PELLUCID_DEVICE, and without it the best GPU, else the best CPU.

    profiling : bool, optional
        Whether kernels are timed; None: unless the environment variable PELLUCID_PROFILING is 0.

    Raises
    ------
    PellucidError
        NO_DEVICE, with the devices found, or the package that brings one.
    """

    _instead = "make one there, pellucid.Device(selector)"

    def __init__(self, selector: str | int = "", profiling: Optional[bool] = None) -> None:
        timed = 2 if profiling is None else int(profiling)
        self._open(_in_flight.interruptible(lambda: _native.Device.create(str(selector), timed)))

    def _open(self, handle: _native.Device) -> None:
        self._handle = handle
        # Other devices do not share memory with NumPy arrays: the bytes move with each submission.
        self._in_place = self.info.type == DeviceType.CPU

    @classmethod
    def from_cl(cls, queue: Any, context: Any = None, device: Any = None) -> Device:
        """A device over the caller's own OpenCL objects; all work goes to that queue.

        Parameters
        ----------
        queue : pyopencl.CommandQueue or int
            An in-order command queue. With handles as integers, `context` and `device` are needed too.
        """
        if context is None:
            context = getattr(queue, "context", None)
        if device is None:
            device = getattr(queue, "device", None)
        self = cls.__new__(cls)
        self._open(_native.Device.from_cl(_cl_address(context, "context"), _cl_address(device, "device"),
                                          _cl_address(queue, "queue")))
        return self

    @property
    def info(self) -> DeviceInfo:
        """Name, units, memory and other properties."""
        return _filled(DeviceInfo, self._handle.info())

    def stats(self) -> DeviceStats:
        """Counters since the device was made. Waits for submitted work first."""
        self.finish()
        return _filled(DeviceStats, self._handle.stats())

    @property
    def cl(self) -> tuple[int, int, int]:
        """The cl_context, cl_device_id and cl_command_queue as integers, for `from_int_ptr` of PyOpenCL."""
        return self._handle.cl()

    def finish(self) -> None:
        """Waits until everything submitted has finished."""
        self._handle.marker().wait()
        _in_flight.sweep()

    def set_name(self, name: str) -> None:
        """A name for errors and the log."""
        self._handle.set_name(name)

    def set_progress(self, callback: Progress | bool | None) -> None:
        """Reports the progress of long work.

        Parameters
        ----------
        callback : callable, True or None
            Called with a fraction in [0, 1] and what is being done; returning False cancels: the call then
            raises PellucidError with the code CANCELLED. An exception cancels too and is passed on. True: a
            `tqdm` bar, or plain lines where tqdm is not installed or stderr is no terminal. None: nothing. It
            runs on the thread of the call; where that waits for a compiler or for counts (Shader.commit,
            warm_up_programs, curvature with a report), on a thread of its own.
        """
        self._handle.progress = progress_bar() if callback is True else (callback or None)

    def __repr__(self) -> str:
        return f"<pellucid.Device {self.info.name}>"


def progress_bar() -> Progress:
    """A progress callback with a bar for each piece of work; see Device.set_progress."""
    try:
        from tqdm.auto import tqdm  # type: ignore[import-untyped,unused-ignore]
    except ImportError:
        tqdm = None
    if not sys.stderr.isatty() and "ipykernel" not in sys.modules:  # notebooks show a bar of their own
        tqdm = None
    bars: dict[str, Any] = {}

    def show(fraction: float, what: str) -> None:
        if tqdm is None:
            if fraction >= 1 or fraction - bars.get(what, -1.0) >= 0.1:
                print(f"{what}: {fraction:.0%}", file=sys.stderr)
                bars[what] = fraction
        else:
            if what not in bars:
                bars[what] = tqdm(total=1.0, desc=what, leave=False,
                                  bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}")
            bars[what].update(fraction - bars[what].n)
        if fraction >= 1:
            bar = bars.pop(what, None)
            if hasattr(bar, "close"):
                bar.close()

    return show


class Event(OfThisProcess):
    """Submitted work. Waiting for it also makes its NumPy results valid."""

    _instead = "wait for it here"

    def __init__(self, handle: _native.Event) -> None:
        self._handle = handle

    @classmethod
    def from_cl(cls, device: Device, event: Any) -> Event:
        """An event from a PyOpenCL event or a cl_event handle, to wait for."""
        return cls(_native.Event.from_cl(device._handle, _cl_address(event, "event")))

    def wait(self) -> None:
        """Waits, without the GIL; Ctrl-C ends the waiting, not the work.

        Raises
        ------
        PellucidError
            The work failed.
        """
        self._handle.wait()
        _in_flight.sweep()

    def __await__(self) -> Generator[Any, None, None]:
        """`await event` waits on a thread of the event loop, which is not blocked."""
        import asyncio  # which takes longer to load than most of this package

        return asyncio.get_running_loop().run_in_executor(None, self.wait).__await__()

    @property
    def done(self) -> bool:
        """Whether the work has finished."""
        return bool(self._handle.is_done())

    @property
    def cl(self) -> int:
        """The cl_event as an integer."""
        return self._handle.cl()


def _handles(waits: Iterable[Event]) -> list[_native.Event]:
    return [e._handle for e in waits]


class Buffer(OfThisProcess):
    """Device memory of the library's own.

    Parameters
    ----------
    device : Device
    initial : int or array
        A size in bytes, zeroed; or an array whose bytes are copied (C order).
    """

    _instead = "pass an array, Buffer.read gives one"

    def __init__(self, device: Device, initial: int | NDArray[Any]) -> None:
        if isinstance(initial, (int, np.integer)):
            self._setup(device, _native.Buffer.create(device._handle, int(initial), 0))
        else:
            values = np.ascontiguousarray(initial)
            self._setup(device, _in_flight.interruptible(
                lambda: _native.Buffer.create(device._handle, values.nbytes, values.ctypes.data), values))

    def _setup(self, device: Device, handle: _native.Buffer, owner: Any = None) -> None:
        self.device = device
        self._handle = handle
        self._owner = owner  # host memory or a PyOpenCL object that must outlive this

    @classmethod
    def from_host(cls, device: Device, array: NDArray[Any]) -> Buffer:
        """An array's own memory, in place. Touch it only inside `mapped()` until this buffer is gone.

        Parameters
        ----------
        array : C-contiguous, writable
            Aligned to 4096 bytes avoids a copy on some devices.
        """
        if not array.flags.c_contiguous or not array.flags.writeable:
            raise ValueError("a buffer from host memory needs a C-contiguous, writable array")
        self = cls.__new__(cls)
        self._setup(device, _native.Buffer.from_host(device._handle, array.ctypes.data, array.nbytes), array)
        return self

    @classmethod
    def from_cl(cls, device: Device, mem: Any) -> Buffer:
        """A pyopencl.Buffer, a 2D pyopencl.Image or a cl_mem handle of the device's context.

        For an image, the buffer is a copy, which a Shader updates when it executes; written textures are
        copied back.
        """
        self = cls.__new__(cls)
        self._setup(device, _native.Buffer.from_cl(device._handle, _cl_address(mem, "mem")), mem)
        return self

    def set_name(self, name: str) -> None:
        """A name for errors and the log."""
        self._handle.set_name(name)

    @property
    def nbytes(self) -> int:
        """Size in bytes."""
        return self._handle.size()

    @property
    def cl(self) -> int:
        """The cl_mem as an integer, for pyopencl.Buffer.from_int_ptr."""
        return self._handle.cl()

    def read(self, out: NDArray[Any], offset: int = 0) -> NDArray[Any]:
        """Copies bytes from `offset` into `out` (C-contiguous, any type) and returns it."""
        self.submit_read(out, offset).wait()
        return out

    def submit_read(self, out: NDArray[Any], offset: int = 0, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting; `out` is valid once the event is done."""
        if not out.flags.c_contiguous or not out.flags.writeable:
            raise ValueError("out must be C-contiguous and writable")
        with _in_flight.kept(self.device._handle, self, out):
            event = self._handle.read(offset, out.nbytes, out.ctypes.data, _handles(waits))
            _in_flight.hold(event, self, out)
        return Event(event)

    def write(self, values: NDArray[Any], offset: int = 0) -> None:
        """Copies the bytes of a C-contiguous array to `offset`."""
        self.submit_write(values, offset).wait()

    def submit_write(self, values: NDArray[Any], offset: int = 0, waits: Iterable[Event] = ()) -> Event:
        """The same after `waits`, without waiting; leave `values` as it is until the event is done."""
        if not values.flags.c_contiguous:
            raise ValueError("values must be C-contiguous")
        with _in_flight.kept(self.device._handle, self, values):
            event = self._handle.write(offset, values.nbytes, values.ctypes.data, _handles(waits))
            _in_flight.hold(event, self, values)
        return Event(event)

    @contextlib.contextmanager
    def mapped(self) -> Iterator[NDArray[np.uint8]]:
        """The bytes, visible to the host inside the `with` block; `.view(dtype)` gives them a type.

        Waits for submitted work. The array must not be used after the block.
        """
        import ctypes

        self.device.finish()
        memory = (ctypes.c_uint8 * self.nbytes).from_address(self._handle.map())
        try:
            yield np.frombuffer(memoryview(memory), np.uint8)
        finally:
            self._handle.unmap()
