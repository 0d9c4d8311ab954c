"""What stands between the page and the session: one thread that renders, a token, and pictures over a socket."""
from __future__ import annotations

import asyncio
import hmac
import io
import json
import math
import time
from concurrent.futures import ThreadPoolExecutor
from http.cookies import SimpleCookie
from typing import Any, Callable, Optional, TypeVar
from urllib.parse import parse_qs

from PIL import Image

from .session import Frame, Session

T = TypeVar("T")
COOKIE = "pellucid_view"
SETTLED = 0.2  # seconds without a motion, after which the picture is drawn in full


class Viewer:
    """One session, and the state that all open pages share. All but `on_thread` belongs to the event loop."""

    def __init__(self, make: Callable[[], Session]) -> None:
        self._make = make
        self._thread = ThreadPoolExecutor(1, "pellucid-view")  # OpenGL contexts belong to a thread
        self.session: Session = self._thread.submit(make).result()
        self.error = ""
        self.last: Optional[Frame] = None
        self.rates: list[float] = []  # seconds of the last frames
        self._changed: set[asyncio.Event] = set()
        self._moved = 0.0

    async def on_thread(self, work: Callable[[], T]) -> T:
        return await asyncio.get_running_loop().run_in_executor(self._thread, work)

    def changed(self, moving: bool = False) -> None:
        """Tells every page to draw again. `moving`: soon once more, so that a rougher picture serves now."""
        self._moved = time.monotonic() if moving else 0.0
        for event in self._changed:
            event.set()

    @property
    def moving(self) -> bool:
        return time.monotonic() - self._moved < SETTLED

    async def restart(self) -> None:
        """A new device and OpenGL context, with the same mesh, look and camera."""
        old = self.session

        def again() -> Session:
            fresh = self._make()
            fresh.look, fresh.other, fresh.wipe = old.look, old.other, old.wipe
            fresh.load(old.mesh.source)
            fresh.orbit = old.orbit
            return fresh

        self.session = await self.on_thread(again)
        self.error = ""
        self.changed()

    async def frame(self, width: int, height: int, small: bool) -> Optional[Frame]:
        """The next picture, or None and `error`."""
        started = time.perf_counter()
        try:
            self.last = await self.on_thread(lambda: self.session.frame(width, height, small))
            self.error = ""
        except Exception as error:  # shown on the page, where another setting may do
            self.error, self.last = f"{type(error).__name__}: {error}", None
        self.rates = [*self.rates[-29:], time.perf_counter() - started]
        return self.last

    def apply(self, message: dict[str, Any]) -> None:
        """A motion of the mouse over the picture."""
        orbit, kind = self.session.orbit, message.get("kind")
        dx, dy = (max(-1.0, min(1.0, float(message.get(k, 0)))) for k in ("dx", "dy"))  # parts of the picture's height
        if kind == "orbit":
            orbit.azimuth = (orbit.azimuth - 120 * dx + 180) % 360 - 180
            orbit.elevation = max(-89.0, min(89.0, orbit.elevation + 120 * dy))
        elif kind == "pan":
            tall = 2 * orbit.distance * math.tan(math.radians(orbit.fov) / 2)
            orbit.pan = (orbit.pan[0] - dx * tall, orbit.pan[1] + dy * tall)
        elif kind == "zoom":
            orbit.distance = max(0.24 * self.session.renderer.radius, min(50 * self.session.renderer.radius, orbit.distance * 1.2 ** (5 * dy)))
        elif kind == "light":
            for look in filter(None, (self.session.look, self.session.other)):
                lamp = look.lamps[0]
                lamp.azimuth = (lamp.azimuth + 120 * dx + 180) % 360 - 180
                lamp.elevation = max(-89.0, min(89.0, lamp.elevation - 120 * dy))
        elif kind == "wipe":
            self.session.wipe = max(0.0, min(1.0, float(message.get("x", 0.5))))
        elif kind != "size":
            return
        self.changed(moving=kind != "size")

    async def stream(self, socket: Any) -> None:
        """Sends pictures to one page, never more than it takes, until it goes."""
        event, size, taken = asyncio.Event(), [960, 540], asyncio.Event()
        self._changed.add(event)
        event.set()

        async def listen() -> None:
            while True:
                message = json.loads(await socket.receive_text())
                if message.get("kind") == "taken":
                    taken.set()
                    continue
                if message.get("kind") == "size":
                    size[:] = (max(16, min(4096, int(message["width"]))), max(16, min(4096, int(message["height"]))))
                self.apply(message)

        async def send() -> None:
            while True:
                await event.wait()
                event.clear()
                small = self.moving
                width, height = (max(16, v // 2) if small else v for v in size)
                frame = await self.frame(width, height, small)
                taken.clear()
                head = {"error": self.error, "moving": small, "width": width, "height": height}
                if frame is not None:
                    started = time.perf_counter()
                    data = io.BytesIO()
                    Image.fromarray(frame.pixels).save(data, "JPEG", quality=80 if small else 92, subsampling=2 if small else 0)
                    frame.milliseconds["JPEG"] = 1e3 * (time.perf_counter() - started)
                    head["milliseconds"] = frame.milliseconds
                    await socket.send_text(json.dumps(head))
                    await socket.send_bytes(data.getvalue())
                else:
                    await socket.send_text(json.dumps(head))
                try:
                    await asyncio.wait_for(taken.wait(), 5)
                except asyncio.TimeoutError:
                    pass
                if small and not event.is_set():
                    asyncio.get_running_loop().call_later(SETTLED, event.set)

        tasks = [asyncio.create_task(listen()), asyncio.create_task(send())]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._changed.discard(event)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)


class TokenGuard:
    """Lets nobody in who does not know the token: once in the address, from then on in a cookie."""

    def __init__(self, app: Any, token: str) -> None:
        self.app, self.token = app, token

    def _is(self, given: str) -> bool:
        return hmac.compare_digest(given.encode(), self.token.encode())

    async def __call__(self, scope: dict[str, Any], receive: Any, send: Any) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers = {k.decode("latin-1").lower(): v.decode("latin-1") for k, v in scope.get("headers", [])}
        cookie: SimpleCookie = SimpleCookie()
        cookie.load(headers.get("cookie", ""))
        known = COOKIE in cookie and self._is(cookie[COOKIE].value)
        # A page of somebody else's may send our cookie along with a socket.
        origin = headers.get("origin", "")
        if known and origin and origin.split("://", 1)[-1] != headers.get("host"):
            known = False
        given = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])[0]
        if known:
            await self.app(scope, receive, send)
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
        elif self._is(given):
            await send({"type": "http.response.start", "status": 303, "headers": [
                (b"location", scope["path"].encode("latin-1", "replace")),
                (b"set-cookie", f"{COOKIE}={self.token}; HttpOnly; SameSite=Strict; Path=/".encode())]})
            await send({"type": "http.response.body", "body": b""})
        else:
            await send({"type": "http.response.start", "status": 403, "headers": [(b"content-type", b"text/plain")]})
            await send({"type": "http.response.body", "body": b"The address needs its token, as the terminal shows it.\n"})
