"""Widgets that set values of the look and have the picture drawn again."""
from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING, Any, Callable

import numpy as np
from nicegui import events, ui

from .. import files
from .look import Look

if TYPE_CHECKING:
    from .page import Page
    from .server import Viewer


def _hex(color: Any) -> str:
    srgb = files.tonemap(np.asarray(color, np.float32).reshape(1, 1, 3), 1.0, 1.0)[0, 0]
    return "#{:02x}{:02x}{:02x}".format(*srgb.tolist())


def _linear(text: str) -> tuple[float, float, float]:
    c = np.array([int(text[i:i + 2], 16) for i in (1, 3, 5)]) / 255
    return tuple(np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4).tolist())  # type: ignore[return-value]


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

    def slider(self, name: str, owner: Any, attribute: str, low: float, high: float, step: float, marker: str = "") -> None:
        with ui.row().classes("w-full items-center no-wrap gap-2"):
            ui.label(name).classes("text-xs").style("width:8.5rem")
            value = ui.label().classes("text-xs text-right").style("width:3.2rem")
            value.bind_text_from(owner, attribute, backward=lambda v: f"{v:.4g}")

            def change(e: events.ValueChangeEventArguments) -> None:
                if e.value is not None and getattr(owner, attribute) != e.value:
                    setattr(owner, attribute, type(getattr(owner, attribute))(e.value))
                    self.viewer.changed(moving=True)

            ui.slider(min=low, max=high, step=step, value=getattr(owner, attribute), on_change=change).props(f"dense data-pel=slider-{marker or attribute}")

    def select(self, name: str, options: Any, attribute: str, then: Callable[[], None] = lambda: None, owner: Any = None, marker: str = "") -> None:
        of = self.look if owner is None else owner
        value = getattr(of, attribute)

        def change(e: events.ValueChangeEventArguments) -> None:
            setattr(of, attribute, e.value)
            then()
            self.viewer.changed()

        ui.select(options, value=value.name.lower() if isinstance(value, IntEnum) else value, label=name, on_change=change).props(
            f"dense options-dense data-pel={marker or attribute}").classes("w-full")

    def switch(self, name: str, owner: Any, attribute: str, marker: str = "") -> None:
        def change(e: events.ValueChangeEventArguments) -> None:
            setattr(owner, attribute, bool(e.value))
            self.viewer.changed()

        ui.switch(name, value=getattr(owner, attribute), on_change=change).props(f"dense data-pel={marker or attribute}").classes("text-xs")

    def color(self, name: str, owner: Any, attribute: str, marker: str = "") -> None:
        def change(e: events.ValueChangeEventArguments) -> None:
            if isinstance(e.value, str) and len(e.value) == 7:
                setattr(owner, attribute, _linear(e.value))
                self.viewer.changed()

        ui.color_input(name, value=_hex(getattr(owner, attribute)), on_change=change).props(f"dense data-pel={marker or attribute}").classes("w-full")

    def channel(self, name: str, attribute: str, c: int, low: float, high: float, step: float, then: Callable[[], None] = lambda: None) -> None:
        self.element(name, self.look, attribute, c, low, high, step, then)

    def element(self, name: str, owner: Any, attribute: str, c: int, low: float, high: float, step: float,
                then: Callable[[], None] = lambda: None) -> None:
        """A slider for one of several numbers."""
        def change(e: events.ValueChangeEventArguments) -> None:
            values = list(getattr(owner, attribute))
            if e.value is not None and values[c] != e.value:
                values[c] = float(e.value)
                setattr(owner, attribute, type(getattr(owner, attribute))(values))
                then()
                self.viewer.changed(moving=True)

        with ui.row().classes("w-full items-center no-wrap gap-2"):
            ui.label(name).classes("text-xs").style("width:8.5rem")
            ui.label().classes("text-xs text-right").style("width:3.2rem").bind_text_from(
                owner, attribute, backward=lambda v: f"{v[c]:.3g}")
            ui.slider(min=low, max=high, step=step, value=getattr(owner, attribute)[c], on_change=change).props(f"dense data-pel=slider-{attribute}-{c}")
