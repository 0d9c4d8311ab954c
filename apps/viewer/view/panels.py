"""The panels of the page."""
from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional

import numpy as np
from nicegui import events, ui

from .._types import MaterialValues
from ..profile import Profile
from ..skin import skin_info
from .look import (
    ARRANGEMENTS,
    CURVES,
    KEPT_BY_PRESETS,
    METHODS,
    MODES,
    PIGMENTS,
    PRESETS,
    SHADOW_SIZES,
    Look,
    profiles,
)
from .session import iris_image, pigments
from .surroundings import STUDIO, read
from .widgets import Panel, fail

if TYPE_CHECKING:
    from .page import Page


def tone_mapping(panel: Panel) -> None:
    panel.slider("Exposure", panel.look, "exposure", 0.1, 4, 0.05)
    panel.select("Tone mapping", CURVES, "curve")
    panel.slider("Highlight roll-off", panel.look, "shoulder", 0.3, 1, 0.05)


class PicturePanel(Panel):
    def build(self) -> None:
        own = self.viewer.memory.part("presets")
        names = [*PRESETS, *own]
        shown = next((name for name in names if self.of_preset(name) == self.look), None)
        ui.select(names, label="Preset", value=shown, on_change=lambda e: self.preset(e.value)).props(
            "dense options-dense data-pel=preset").classes("w-full")
        with ui.row().classes("w-full items-center no-wrap gap-2"):
            name = ui.input("Preset of your own", value=shown if shown in own else "").props(
                "dense data-pel=own-name").style("flex:1")
            ui.button("Save", on_click=lambda: self.keep(name.value.strip())).props("dense data-pel=own-save")
            ui.button("Delete", on_click=lambda: self.drop(name.value.strip())).props(
                "dense flat data-pel=own-delete")
        self.select("Picture", MODES, "mode")
        self.slider("False-colour white", self.look, "white", 0.05, 4, 0.05)
        self.switch("Histogram", self.viewer, "histogram")
        tone_mapping(self)

    def keep(self, name: str) -> None:
        if not name or name in PRESETS:
            fail(f"{name} is a preset of the program: choose another name" if name else "name the preset")
            return
        self.save(name, self.look.to_dict())

    def drop(self, name: str) -> None:
        if name in self.viewer.memory.part("presets"):
            self.save(name, None)

    def save(self, name: str, values: Optional[dict[str, Any]]) -> None:
        try:
            self.viewer.memory.update(presets={name: values})
        except OSError as error:
            fail(error)
        self.viewer.rebuild()

    def of_preset(self, name: str) -> Optional[Look]:
        """The preset's material with the current light and view; None if the preset is damaged."""
        try:
            new = Look.from_dict(PRESETS.get(name) or self.viewer.memory.part("presets").get(name, {}))
        except (TypeError, ValueError):
            return None
        for kept in KEPT_BY_PRESETS:
            setattr(new, kept, getattr(self.look, kept))
        if new.profile == "pigments":
            self.viewer.session.take_pigments(new)
        return new

    def preset(self, name: str) -> None:
        new = self.of_preset(name) if name else None
        if new is not None:
            self.viewer.session.look = new
            self.viewer.rebuild()


class MaterialPanel(Panel):
    name, open = "Material", True

    def build(self) -> None:
        self.select("Scattering", METHODS, "method")
        self.field("target_error")
        self.slider("Radius scale", self.look, "radius_scale", 0.1, 5, 0.05)
        for value in fields(MaterialValues):
            self.field(value.name)
        self.switch("Dual-lobe GGX", self.look, "ggx")
        self.slider("Pores", self.look, "pores", 0, 0.5, 0.01)
        self.channels("Albedo scale, {}", "albedo", 0.0, 2.0, 0.01)
        self.channels("Deep scatter, {}", "deep_scatter", 0.0, 3.0, 0.05)


class SkinPanel(Panel):
    name = "Skin"

    def __init__(self, page: Page, profile: ProfilePanel) -> None:
        super().__init__(page)
        self.profile = profile

    def build(self) -> None:
        for key in PIGMENTS:
            self.field(key, then=self.follow)
        self.numbers = ui.label().classes("text-xs").props("data-pel=skin-numbers")
        self.tell()

    def tell(self) -> None:
        info = skin_info(pigments(self.look))
        lightness, a, b = info.lab
        travels = ", ".join(f"{d:.2f}" for d in info.mean_distance)
        self.numbers.set_text(f"L* {lightness:.0f}, a* {a:.0f}, b* {b:.0f}, "
                              f"ITA {info.typology_angle:.0f} degrees; light travels {travels} mm")

    def follow(self) -> None:
        """Profile and albedo are those of the pigments."""
        self.viewer.session.take_pigments(self.look)
        self.page.follow()
        self.profile.draw_profile()
        self.tell()


class EyesPanel(Panel):
    name = "Eyes"

    def build(self) -> None:
        if not self.viewer.session.mesh.eyes:
            ui.label("This mesh comes without eyes; the heads of the package have some.").classes("text-xs")
        self.field("pupil_radius", attribute="pupil")
        self.color("Iris", self.look, "iris_color", "iris-color")
        self.field("iris_seed")
        self.field("iris_concavity")
        profiles = {"": "None", **{name: name for name in Profile.library_names()}}
        self.select("Scattering in the iris", profiles, "iris_profile")
        for key in ("limbus_width", "limbus_darkening", "cornea_radius", "chamber_depth", "tear_roughness"):
            self.field(key)
        self.slider("Gaze to the left, degrees", self.look, "gaze", -40, 40, 1, index=0)
        self.slider("Gaze up, degrees", self.look, "gaze", -30, 30, 1, index=1)

        async def dropped(e: events.UploadEventArguments) -> bool:
            path = await self.keep_file(e, iris_image)
            if not path:  # the previous iris stays
                return False
            self.look.iris_texture, self.look.iris_color = path, (1.0, 1.0, 1.0)
            self.viewer.rebuild()
            return True

        def fibres() -> None:
            self.look.iris_texture, self.look.iris_color = "", Look().iris_color
            self.viewer.rebuild()

        self.upload("Drop an image of an iris here", dropped, "iris-upload", 1 << 28)
        if self.look.iris_texture:
            self.button("Draw fibres instead", fibres, "iris-fibres", flat=True)


class LightsPanel(Panel):
    name = "Lights"

    def build(self) -> None:
        ui.select(list(ARRANGEMENTS), label="Arrangement", on_change=lambda e: self.arrange(e.value)).props(
            "dense options-dense data-pel=arrangement").classes("w-full")
        self.slider("Ambient", self.look, "ambient", 0, 1, 0.01)
        around = self.look.surroundings
        names = {"": "None", **({around: Path(around).name} if around else {}), STUDIO: "Studio"}
        self.select("Surroundings", names, "surroundings")
        self.slider("Surroundings, light", self.look, "surroundings_light", 0, 4, 0.05)
        self.slider("Surroundings, turn", self.look, "surroundings_turn", -180, 180, 1)
        self.upload("Drop an image of the surroundings here (HDR, EXR)", self.surround, "around-upload",
                    1 << 29)
        self.select("Shadow map, texels", SHADOW_SIZES, "shadow_size")
        for i, lamp in enumerate(self.look.lamps):
            self.switch(lamp.name, lamp, "on", f"lamp-{i}-on")
            self.slider("Intensity", lamp, "intensity", 0, 4, 0.05, f"lamp-{i}-intensity")
            self.slider("Azimuth", lamp, "azimuth", -180, 180, 1, f"lamp-{i}-azimuth")
            self.slider("Elevation", lamp, "elevation", -89, 89, 1, f"lamp-{i}-elevation")
            self.color("Colour", lamp, "color", f"lamp-{i}-color")
            self.switch("Shadow", lamp, "shadow", f"lamp-{i}-shadow")

    def arrange(self, name: str) -> None:
        """Places the lamps; colours and shadows stay."""
        for lamp, (azimuth, elevation, intensity) in zip(self.look.lamps, ARRANGEMENTS.get(name, ())):
            lamp.azimuth, lamp.elevation, lamp.intensity, lamp.on = azimuth, elevation, intensity, True
        self.page.follow()
        self.viewer.changed()

    async def surround(self, e: events.UploadEventArguments) -> bool:
        path = await self.keep_file(e, read)
        if not path:  # the surroundings before stay
            return False
        self.look.surroundings = path
        self.viewer.rebuild()
        return True


class ProfilePanel(Panel):
    name = "Profile"

    def build(self) -> None:
        self.select("Profile", profiles(), "profile", self.chosen)
        self.channels("Custom d, {}, mm", "distance", 0.01, 5.0, 0.01, self.draw_profile)
        text = {"color": "#ccc"}
        lines = [{"type": "line", "showSymbol": False, "data": [], "lineStyle": {"color": color}}
                 for color in ("#f66", "#6d6", "#69f")]
        self.curve = ui.echart({
            "animation": False, "grid": {"left": 45, "right": 10, "top": 25, "bottom": 40}, "textStyle": text,
            "title": {"text": "light by distance: 2πr R(r), 1/mm", "textStyle": {"fontSize": 11, **text}},
            "xAxis": {"type": "value", "name": "mm", "nameLocation": "middle", "nameGap": 25},
            "yAxis": {"type": "value"}, "series": lines}).style("height:13rem;width:100%")
        self.draw_profile()

    def chosen(self) -> None:
        if self.look.profile == "pigments":
            self.viewer.session.take_pigments(self.look)
            self.page.follow()
        self.draw_profile()

    def draw_profile(self) -> None:
        p = self.viewer.session.profile(self.look)
        scale = self.look.radius_scale
        r = np.linspace(0.01, 0.5 * p.info.reach, 120)
        radial, _ = p.evaluate(r)
        for c, series in enumerate(self.curve.options["series"]):
            series["data"] = np.stack([r * scale, 2 * np.pi * r * radial[:, c] / scale], 1).round(5).tolist()
        self.curve.update()


class ComparePanel(Panel):
    name = "Compare"

    def build(self) -> None:
        session = self.viewer.session

        def keep(other: Look | None) -> None:
            session.other = other
            self.viewer.changed()

        def swap() -> None:
            if session.other is not None:
                session.look, session.other = session.other, session.look
                self.viewer.rebuild()

        ui.label("Compares two pictures. On the right of the divider: another method, or the settings stored "
                 "by Keep. On the left: the current settings. Alt and drag moves the divider."
                 ).classes("text-xs")
        self.select("On the right", {"": "The settings stored by Keep", **METHODS}, "against", owner=session)
        self.switch("Side by side", session, "beside")
        with ui.row():
            for name, act in (("Keep", lambda: keep(self.look.copy())), ("Swap", swap),
                              ("Drop", lambda: keep(None))):
                ui.button(name, on_click=act).props(f"dense data-pel=wipe-{name.lower()}")
        self.slider("Divider", session, "wipe", 0, 1, 0.01)
