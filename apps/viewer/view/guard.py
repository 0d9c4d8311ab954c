"""Who may see the page: an address with a key that is valid once, and a cookie from then on.

The key of an address shows in lists of processes and in histories of browsers; the cookie's value shows
nowhere.
"""
from __future__ import annotations

import hmac
import secrets
from typing import Any, Callable
from urllib.parse import parse_qs


def cookie_values(header: str, name: str) -> list[str]:
    """The values of the cookie `name`. Other programs on this host set cookies too, in any form: those are
    skipped."""
    found = []
    for part in header.split(";"):
        key, equals, value = part.partition("=")
        if equals and key.strip() == name:
            found.append(value.strip().strip('"'))
    return found


def _same(a: str, b: str) -> bool:
    return hmac.compare_digest(a.encode("utf-8", "replace"), b.encode("utf-8", "replace"))


class Keys:
    """Keys of addresses, each valid once, and the cookie that one is exchanged for.

    Parameters
    ----------
    port : int
        Part of the cookie's name: browsers keep cookies by host alone, and several viewers may run.
    chosen : str
        A key that stays valid, chosen by the user; "": none.
    used : called with the next key when one has been used
    """

    def __init__(self, port: int, chosen: str = "", used: Callable[[str], None] = lambda key: None) -> None:
        self.cookie, self.value = f"pellucid_view_{port}", secrets.token_urlsafe(24)
        self._chosen, self._used = chosen, used
        self.key = chosen or secrets.token_urlsafe(16)

    def take(self, given: str) -> bool:
        """Whether this is the key; a random one is replaced."""
        if not _same(given, self.key):
            return False
        if not self._chosen:
            self.key = secrets.token_urlsafe(16)
            self._used(self.key)
        return True

    def holds(self, header: str) -> bool:
        """Whether the cookies of a request include the viewer's own."""
        return any(_same(value, self.value) for value in cookie_values(header, self.cookie))


class Guard:
    """ASGI middleware that lets in requests with the key or the cookie."""

    def __init__(self, app: Any, keys: Keys) -> None:
        self.app, self.keys = app, keys

    async def __call__(self, scope: dict[str, Any], receive: Any, send: Any) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers: dict[str, str] = {}
        for name, value in scope.get("headers", []):
            key, text = name.decode("latin-1").lower(), value.decode("latin-1")
            headers[key] = f"{headers[key]};{text}" if key == "cookie" and key in headers else text
        known = self.keys.holds(headers.get("cookie", ""))
        # A page of another origin may open a socket, and the browser then sends the cookie along.
        origin = headers.get("origin", "")
        if known and origin and origin.split("://", 1)[-1] != headers.get("host"):
            known = False
        given = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])[0]
        if known:
            await self.app(scope, receive, send)
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
        elif self.keys.take(given):
            cookie = f"{self.keys.cookie}={self.keys.value}; HttpOnly; SameSite=Strict; Path=/"
            await send({"type": "http.response.start", "status": 303, "headers": [
                (b"location", scope["path"].encode("latin-1", "replace")), (b"set-cookie", cookie.encode())]})
            await send({"type": "http.response.body", "body": b""})
        else:
            await send({"type": "http.response.start", "status": 403,
                        "headers": [(b"content-type", b"text/plain")]})
            await send({"type": "http.response.body",
                        "body": b"This address needs its token, which is valid once: take the last address "
                                b"from the terminal.\n"})
