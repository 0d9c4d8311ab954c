"""Widgets that set values of the look and have the picture drawn again."""
from __future__ import annotations

import contextlib
from enum import IntEnum
from typing import TYPE_CHECKING, Any, Callable, Optional

from nicegui import events, ui

from .._show import linear, srgb
from .._types import SLIDERS
from .look import Look

if TYPE_CHECKING:
    from .page import Page
    from .server import Viewer


def _hex(color: Any) -> str:
    return "#{:02x}{:02x}{:02x}".format(*srgb(color).tolist())


def _linear(text: str) -> tuple[float, float, float]:
    red, green, blue = linear([int(text[i:i + 2], 16) / 255 for i in (1, 3, 5)]).tolist()
    return red, green, blue


def fail(message: object) -> None:
    """An error that stays on the page until it is closed."""
    ui.notify(f"{message}", type="negative", multi_line=True, close_button=True, timeout=0)


class Panel:
    """A part of the page: `name` is its heading, `build` makes its widgets."""

    name = ""
    open = False

    def __init__(self, page: Page) -> None:
        self.page = page

    @property
    def viewer(self) -> Viewer:
        return self.page.viewer

    @property
    def look(self) -> Look:
        return self.viewer.session.look

    def build(self) -> None:
        raise NotImplementedError

    async def deliver(self, make: Callable[[], bytes], name: str) -> None:
        """Makes a file on the session's thread, for the browser to download unless the page was closed."""
        client = ui.context.client
        try:
            data = await self.viewer.on_thread(make)
            if client.has_socket_connection:
                with client:
                    ui.download(data, name)
        except Exception as error:
            with contextlib.suppress(RuntimeError), client:  # of a page that is gone
                fail(error)
        self.viewer.changed()

    async def keep_file(self, e: events.UploadEventArguments, read: Callable[[Any], Any]) -> str:
        """Stores a file that was dropped on the page, and returns its path; if `read` raises, shows the
        reason and returns ""."""
        path = self.viewer.keep(e.file.name, await e.file.read())
        try:
            await self.viewer.on_thread(lambda: read(path))
        except Exception as error:
            fail(f"{e.file.name}: {error}")
            return ""
        return str(path)

    def slider(self, name: str, owner: Any, attribute: str, low: float, high: float, step: float,
               marker: str = "", index: Optional[int] = None,
               then: Callable[[], None] = lambda: None) -> None:
        """A slider for a number, or for element `index` of several."""
        def value() -> Any:
            whole = getattr(owner, attribute)
            return whole if index is None else whole[index]

        def change(e: events.ValueChangeEventArguments) -> None:
            if e.value is None or value() == e.value:
                return
            whole = getattr(owner, attribute)
            new = e.value if index is None else [*whole[:index], float(e.value), *whole[index + 1:]]
            setattr(owner, attribute, type(whole)(new))
            then()
            self.viewer.changed(moving=True)

        marker = marker or (attribute if index is None else f"{attribute}-{index}")
        with ui.row().classes("w-full items-center no-wrap gap-2"):
            ui.label(name).classes("text-xs").style("width:8.5rem")
            ui.label().classes("text-xs text-right").style("width:3.2rem").bind_text_from(
                owner, attribute, backward=lambda v: f"{v if index is None else v[index]:.4g}")
            self.page.shown.append((value, ui.slider(
                min=low, max=high, step=step, value=value(), on_change=change).props(
                    f"dense data-pel=slider-{marker}")))

    def field(self, key: str, owner: Any = None, attribute: str = "", marker: str = "",
              then: Callable[[], None] = lambda: None) -> None:
        """The slider of a field of the library."""
        label, low, high, step = SLIDERS[key]
        self.slider(label, self.look if owner is None else owner, attribute or key, low, high, step, marker,
                    then=then)

    def channels(self, name: str, attribute: str, low: float, high: float, step: float,
                 then: Callable[[], None] = lambda: None) -> None:
        """A slider for each colour, which goes into the name."""
        for index, color in enumerate(("red", "green", "blue")):
            self.slider(name.format(color), self.look, attribute, low, high, step, index=index, then=then)

    def select(self, name: str, options: Any, attribute: str, then: Callable[[], None] = lambda: None,
               owner: Any = None, marker: str = "") -> None:
        of = self.look if owner is None else owner

        def value() -> Any:
            now = getattr(of, attribute)
            return now.name.lower() if isinstance(now, IntEnum) else now

        def change(e: events.ValueChangeEventArguments) -> None:
            if e.value == value():
                return
            setattr(of, attribute, e.value)
            then()
            self.viewer.changed()

        self.page.shown.append((value, ui.select(options, value=value(), label=name, on_change=change).props(
            f"dense options-dense data-pel={marker or attribute}").classes("w-full")))

    def switch(self, name: str, owner: Any, attribute: str, marker: str = "") -> None:
        def change(e: events.ValueChangeEventArguments) -> None:
            setattr(owner, attribute, bool(e.value))
            self.viewer.changed()

        ui.switch(name, value=getattr(owner, attribute), on_change=change).props(
            f"dense data-pel={marker or attribute}").classes("text-xs")

    def color(self, name: str, owner: Any, attribute: str, marker: str = "") -> None:
        def change(e: events.ValueChangeEventArguments) -> None:
            if isinstance(e.value, str) and len(e.value) == 7:
                setattr(owner, attribute, _linear(e.value))
                self.viewer.changed()

        ui.color_input(name, value=_hex(getattr(owner, attribute)), on_change=change).props(
            f"dense data-pel={marker or attribute}").classes("w-full")

    def button(self, name: str, act: Any, marker: str, flat: bool = False) -> None:
        style = f"dense {'flat ' if flat else ''}data-pel={marker}"
        ui.button(name, on_click=act).props(style).classes("w-full")

    def upload(self, name: str, act: Any, marker: str, largest: int = 1 << 30) -> None:
        async def take(e: events.UploadEventArguments) -> None:
            if await act(e) is False:
                e.sender.reset()  # or the list would show the file as taken

        ui.upload(label=name, auto_upload=True, on_upload=take, max_file_size=largest).props(
            f"dense flat data-pel={marker}").classes("w-full")
