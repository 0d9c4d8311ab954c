"""Who may see the page: an address with a key that is valid once, and a cookie from then on.

The key of an address shows in lists of processes and in histories of browsers; the cookie's value shows
nowhere.
"""
from __future__ import annotations

import hmac
import secrets
from typing import Any, Callable

from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse, RedirectResponse, Response


def cookie_values(header: str, name: str) -> list[str]:
    """The values of the cookie `name`. Cookies of other programs on this host, of any form, are skipped."""
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
        request = HTTPConnection(scope)
        known = self.keys.holds(";".join(request.headers.getlist("cookie")))
        # A page of another origin may open a socket, and the browser then sends the cookie along.
        origin = request.headers.get("origin", "")
        if known and (not origin or origin.split("://", 1)[-1] == request.headers.get("host")):
            await self.app(scope, receive, send)
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
        elif self.keys.take(request.query_params.get("token", "")):
            answer: Response = RedirectResponse(scope["path"], 303)
            answer.set_cookie(self.keys.cookie, self.keys.value, httponly=True, samesite="strict")
            await answer(scope, receive, send)
        else:
            answer = PlainTextResponse("This address needs its token, which is valid once: take the last "
                                       "address from the terminal.\n", 403)
            await answer(scope, receive, send)
