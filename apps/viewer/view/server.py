"""Between page and session: one thread that renders, and pictures over a socket."""
from __future__ import annotations

import asyncio
import contextlib
import io
import json
import math
import tempfile
import time
import weakref
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Callable, Optional, TypeVar

from PIL import Image

from .._errors import PellucidError
from ..device import Device
from .history import History
from .memory import Memory, standard_file
from .pictures import SCALE, histogram
from .probe import describe_pixel, place
from .session import Frame

T = TypeVar("T")
SETTLED = 0.2  # seconds without a motion, after which the picture is drawn in full
# The picture becomes smaller above this many seconds per picture, while a view or a light moves, and larger
# below MUCH of them. While a light moves, its sides are scaled by no less than LEAST_LIGHT.
SLOW, SLOW_LIGHT, MUCH, LEAST_LIGHT = 1 / 20, 1 / 26, 0.7, 0.8


class Pace:
    """Chooses how many pixels are shaded and shown during motion, so that pictures come in time."""

    # Scale of the sides, and n: one of n pixels of a row or column is shaded.
    STEPS = ((1.0, 1), (1.0, 2), (1.0, 3), (1.0, 4), (0.8, 4), (0.65, 4), (0.5, 4))

    def __init__(self) -> None:
        self._step = 2
        self._last: Optional[float] = None
        self._periods: list[float] = []
        self._rest = 0  # number of pictures before larger ones, which were too slow, are tried again

    @property
    def step(self) -> tuple[float, int]:
        return self.STEPS[self._step]

    def shown(self, now: float, moving: bool, slow: float = SLOW) -> None:
        """A picture has been taken at `now`."""
        if not moving:
            self._last = None
            self._periods.clear()
            return
        if self._last is not None and now - self._last < 1:
            self._periods.append(now - self._last)
        self._last = now
        if len(self._periods) < 7:
            return
        self._rest = max(self._rest - len(self._periods), 0)
        period = sum(sorted(self._periods)[:-1]) / (len(self._periods) - 1)  # one may have been held up
        self._periods.clear()
        if period > (slow if self.step[0] > LEAST_LIGHT else SLOW):
            self._step = min(self._step + 1, len(self.STEPS) - 1)
            self._rest = 60
        elif self._step > 0 and not self._rest:
            (larger, fewer), (scale, every) = self.STEPS[self._step - 1], self.step
            pixels = (larger * every / (scale * fewer))**2
            if period * (0.5 + 0.5 * pixels) < MUCH * slow:  # about half of the time is spent on pixels
                self._step -= 1


class Viewer:
    """One session, and the state that all open pages share. All but `on_thread` belongs to the event loop."""

    def __init__(self, open_device: Callable[[], Device], make: Callable[[Device], Any],
                 memory: Optional[Memory] = None) -> None:
        self._open = open_device
        self.memory = Memory(standard_file()) if memory is None else memory
        self.changes = 0
        self._preparing: Optional[int] = None  # kernels, at this change count: the next change ends it
        self._thread = ThreadPoolExecutor(1, "pellucid-view")  # OpenGL contexts belong to a thread
        self._opening = self._thread.submit(lambda: make(self._device()))
        self._folder, self._kept = tempfile.TemporaryDirectory(), 0
        self.pages: weakref.WeakSet[Any] = weakref.WeakSet()
        self.error = ""
        self.last: Optional[Frame] = None
        self.busy = ""  # what takes long just now
        self.stamp = 0.0  # of the browser's clock: the last motion that was applied
        self.histogram = False  # whether pictures at rest come with theirs
        self.resumed = False  # whether the session shows what was open last
        self._placed = False  # whether the camera was moved: until then it frames the object
        self._aspect = 16 / 9
        self._pace, self._slow = Pace(), SLOW
        self._noted = 0.0
        self._changed: set[asyncio.Event] = set()
        self._loop: Optional[asyncio.AbstractEventLoop] = None
        self._moved = 0.0

    def opened(self) -> Viewer:
        """Waits until there is a session. Raises what opening it raised."""
        self.session: Any = self._opening.result()  # a Session or a SceneSession
        self.session.report = self._advanced
        self._history = History(self.session)
        # Prepares programs and memory before a page requests the first picture.
        self._thread.submit(lambda: self.session.frame(960, 540))
        return self

    def _device(self) -> Device:
        device = self._open()

        def progress(fraction: float, what: str) -> bool:
            self.busy = what if fraction < 1 and what.startswith("building") else ""
            return self._preparing is None or self._preparing == self.changes

        device.set_progress(progress)
        return device

    def keep(self, name: str, data: bytes) -> Path:
        """Writes a file that the page was given, to be there as long as the viewer."""
        self._kept += 1
        path = Path(self._folder.name) / f"{self._kept}{Path(name).suffix.lower()}"
        path.write_bytes(data)
        return path

    async def on_thread(self, work: Callable[[], T]) -> T:
        return await asyncio.get_running_loop().run_in_executor(self._thread, work)

    def changed(self, moving: bool = False) -> None:
        """Tells every page to draw again. `moving`: more changes follow, so a rougher picture suffices."""
        now = time.monotonic()
        self._moved = now if moving else 0.0
        self.changes += 1
        if not moving or now - self._noted > 0.1:  # a copy of all settings: of a motion, few and the last
            self._noted = now
            self._history.note(self.session)
        self._draw()

    def _draw(self) -> None:
        for event in self._changed:
            event.set()

    def _advanced(self) -> None:
        """A reference has advanced, on its own thread: every page draws again."""
        if self._loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop is closed: the viewer has ended
                self._loop.call_soon_threadsafe(self._draw)

    @property
    def moving(self) -> bool:
        return time.monotonic() - self._moved < SETTLED

    def rebuild(self) -> None:
        """Builds the widgets of every page anew: settings that they are bound to were replaced."""
        for page in list(self.pages):
            if not page.column.is_deleted:
                page.build()
        self.changed()

    def undo(self) -> bool:
        """Undoes the last change. Returns whether there was one."""
        self._history.note(self.session)
        return self._history.undo(self.session)

    def redo(self) -> bool:
        return self._history.redo(self.session)

    def frame_object(self) -> None:
        """Moves the camera back so that the whole object is in the picture."""
        session = self.session
        session.orbit.frame(session.mesh.low, session.mesh.high, self._aspect)

    def new_object(self) -> None:
        """After another mesh has been loaded: the camera frames it until it is moved."""
        self._placed = self.resumed = False
        self.frame_object()
        self._history = History(self.session)  # its cameras frame the mesh before

    async def restart(self) -> None:
        """A new device and OpenGL context, with the same mesh, look and camera."""
        self.session = await self.on_thread(lambda: self.session.restarted(self._device()))
        self.error = ""
        self.rebuild()

    async def frame(self, width: int, height: int, small: int,
                    sample: int = 0) -> Optional[tuple[Frame, bytes]]:
        """The next picture and its JPEG file, or None and `error`."""
        def make() -> tuple[Frame, bytes]:
            frame = self.session.frame(width, height, small, sample)
            started = time.perf_counter()
            data = io.BytesIO()
            Image.fromarray(frame.pixels).save(data, "JPEG", quality=80 if small else 92,
                                               subsampling=2 if small else 0)
            frame.milliseconds["JPEG"] = 1e3 * (time.perf_counter() - started)
            return frame, data.getvalue()

        try:
            made = await self.on_thread(make)
            self.last, self.error = made[0], ""
            return made
        except Exception as error:  # shown on the page, where another setting may do
            self.error, self.last = f"{type(error).__name__}: {error}", None
        finally:
            self.busy = getattr(self.session, "work", "")
        return None

    def apply(self, message: dict[str, Any]) -> None:
        """A motion of the mouse over the picture."""
        kind = message.get("kind")
        if kind != "size" and not hasattr(self.session, "orbit"):  # a scene's camera stays
            return
        orbit = getattr(self.session, "orbit", None)
        # parts of the picture's height
        dx, dy = (max(-1.0, min(1.0, float(message.get(k, 0)))) for k in ("dx", "dy"))
        if kind == "orbit":
            orbit.azimuth = (orbit.azimuth - 120 * dx + 180) % 360 - 180
            orbit.elevation = max(-89.0, min(89.0, orbit.elevation + 120 * dy))
        elif kind == "pan":
            tall = 2 * orbit.distance * math.tan(math.radians(orbit.fov) / 2)
            orbit.pan = (orbit.pan[0] - dx * tall, orbit.pan[1] + dy * tall)
        elif kind == "zoom":
            orbit.distance = max(0.24 * self.session.renderer.radius,
                                 min(50 * self.session.renderer.radius, orbit.distance * 1.2 ** (5 * dy)))
        elif kind == "surroundings":
            for look in filter(None, (self.session.look, self.session.other)):
                look.surroundings_turn = (look.surroundings_turn + 120 * dx + 180) % 360 - 180
        elif kind == "light":
            for look in filter(None, (self.session.look, self.session.other)):
                lamp = look.lamps[0]
                lamp.azimuth = (lamp.azimuth + 120 * dx + 180) % 360 - 180
                lamp.elevation = max(-89.0, min(89.0, lamp.elevation - 120 * dy))
        elif kind == "size":
            self._aspect = float(message["width"]) / max(float(message["height"]), 1)
            if not (self._placed or self.resumed) and orbit is not None:
                self.frame_object()
        elif kind == "wipe":
            self.session.wipe = max(0.0, min(1.0, float(message.get("x", 0.5))))
        else:
            return
        self._placed = self._placed or kind in ("orbit", "pan", "zoom")
        self._slow = SLOW_LIGHT if kind in ("light", "surroundings") else SLOW
        self.stamp = float(message.get("at", self.stamp))
        self.changed(moving=kind != "size")

    async def point(self, message: dict[str, Any]) -> Optional[str]:
        """The facts of the pixel at `x`, `y`; for a pivot the camera turns about it from now on."""
        session, x, y = self.session, float(message.get("x", -1)), float(message.get("y", -1))
        if not hasattr(session, "shown"):
            return None
        if message["kind"] == "probe":
            return await self.on_thread(lambda: describe_pixel(session, x, y))
        at = await self.on_thread(lambda: place(session, x, y))
        if at is not None:
            px, py, pz = (at - session.centre).tolist()
            session.orbit.pan, session.orbit.pivot, self._placed = (0.0, 0.0), (px, py, pz), True
            self.changed()
        return None

    async def _prepare(self, width: int, height: int) -> None:
        """Builds kernels while no page requests a picture. A request waits only for the kernel that is being
        built; the others are built at the next rest."""
        self._preparing = self.changes
        try:
            await self.on_thread(lambda: self.session.prepare(width, height))
        except PellucidError:
            pass  # a change cancelled it; any other error shows when a slider needs these kernels
        finally:
            self._preparing, self.busy = None, ""

    async def stream(self, socket: Any) -> None:
        """Sends pictures to one page until it is closed; at most one picture is in flight, so that both sides
        work at the same time."""
        event, size, news = asyncio.Event(), [960, 540], asyncio.Event()
        sent = taken = 0
        self._loop = asyncio.get_running_loop()
        self._changed.add(event)
        event.set()

        async def listen() -> None:
            nonlocal taken
            while True:
                message = json.loads(await socket.receive_text())
                kind = message.get("kind")
                if kind == "taken":
                    self._pace.shown(time.monotonic(), self.moving, self._slow)
                    taken = min(taken + 1, sent)
                    news.set()
                elif kind == "restart":
                    try:
                        await self.restart()
                    except Exception as error:
                        self.error = f"{type(error).__name__}: {error}"
                        event.set()
                elif kind in ("probe", "pivot"):
                    facts = await self.point(message)
                    if facts is not None:
                        await socket.send_text(json.dumps({"probe": facts}))
                else:
                    if kind == "size":
                        size[:] = (max(16, min(4096, int(message["width"]))),
                                   max(16, min(4096, int(message["height"]))))
                    self.apply(message)

        async def send() -> None:
            nonlocal sent, taken
            sample = 0
            while True:
                # At rest, one picture after the other makes edges smoother, until something changes.
                if sample == 0 or self.error or sample >= self.session.samples:
                    await event.wait()
                if event.is_set():
                    sample = 0
                event.clear()
                scale, small = self._pace.step if self.moving else (1, 0)
                width, height = (max(16, round(v * scale)) for v in size)
                changes, stamp = self.changes, self.stamp
                made = await self.frame(width, height, small, 0 if small else sample)
                if not small:
                    self._history.note(self.session)
                sample = 0 if small else sample + 1
                head = {"error": self.error, "moving": small > 0, "width": width, "height": height,
                        "changes": changes, "at": stamp, "sample": sample}
                if made is not None:
                    frame = made[0]
                    head |= {"milliseconds": frame.milliseconds, "kernels": frame.kernels,
                             "compiled": frame.compiled, "standsIn": frame.stands_in}
                    if self.session.look.mode == "false_color":
                        head["scale"] = {"colors": SCALE, "low": "0",
                                         "high": f"{self.session.look.white:.3g}"}
                    if self.histogram and not small:
                        head["histogram"] = histogram(frame.pixels)
                sent += 1
                await socket.send_text(json.dumps(head))
                if made is not None:
                    await socket.send_bytes(made[1])
                while sent - taken > 1:
                    news.clear()
                    try:
                        await asyncio.wait_for(news.wait(), 5)
                    except asyncio.TimeoutError:
                        taken = sent
                stands_in = made is not None and made[0].stands_in
                if stands_in:
                    sample = 0  # until the kernels are ready, one picture is as good as eight
                elif made is not None and not small and sample >= self.session.samples and not event.is_set():
                    await self._prepare(width, height)
                if (stands_in or small) and not event.is_set():
                    asyncio.get_running_loop().call_later(SETTLED, event.set)

        async def report_busy() -> None:
            sent_busy = ""
            while True:
                await asyncio.sleep(0.25)
                if self.busy != sent_busy:
                    sent_busy = self.busy
                    await socket.send_text(json.dumps({"busy": sent_busy}))

        tasks = [asyncio.create_task(part()) for part in (listen, send, report_busy)]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._changed.discard(event)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
