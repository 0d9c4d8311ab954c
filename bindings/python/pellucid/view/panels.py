"""The parts of the page that set what is shown."""
from __future__ import annotations

import numpy as np
from nicegui import events, ui

from ..profile import Profile
from .iris import iris_image
from .look import METHODS, MODES, PRESETS, Look
from .widgets import Panel


class PicturePanel(Panel):
    def build(self) -> None:
        with ui.row().classes("w-full no-wrap"):
            ui.select(list(PRESETS), label="Preset", on_change=lambda e: self.preset(e.value)).props("dense options-dense data-pel=preset").classes("w-full")
        self.select("Picture", MODES, "mode")
        self.slider("Exposure", self.look, "exposure", 0.1, 4, 0.05)
        self.select("Tone mapping", {"soft": "Soft", "none": "None", "filmic": "Filmic", "agx-like": "AgX-like"}, "curve")
        self.slider("Shoulder", self.look, "shoulder", 0.3, 1, 0.05)

    def preset(self, name: str) -> None:
        if name not in PRESETS:
            return
        old, new = self.look, Look.from_dict(PRESETS[name])
        for keep in ("lamps", "ambient", "shadow_size", "exposure", "curve", "shoulder", "mode", "target_error"):
            setattr(new, keep, getattr(old, keep))
        self.viewer.session.look = new
        self.page.build()
        self.viewer.changed()


class MaterialPanel(Panel):
    name, open = "Material", True

    def build(self) -> None:
        self.select("Scattering", METHODS, "method")
        self.slider("Target error", self.look, "target_error", 0.0005, 0.02, 0.0005)
        self.slider("Radius, times", self.look, "radius_scale", 0.1, 5, 0.05)
        self.slider("Transmission", self.look, "transmission", 0, 2, 0.05)
        self.slider("Specular", self.look, "specular", 0, 1, 0.01)
        self.slider("Roughness", self.look, "roughness", 0.05, 1, 0.01)
        self.slider("f0", self.look, "f0", 0.0, 0.2, 0.002)
        self.switch("Two lobes of GGX", self.look, "ggx")
        self.slider("Second roughness", self.look, "roughness2", 0.05, 1, 0.01)
        self.slider("Its share", self.look, "lobe_mix", 0, 1, 0.01)
        self.slider("Pores", self.look, "pores", 0, 0.5, 0.01)
        for c, name in enumerate(("Albedo red, times", "green", "blue")):
            self.channel(name, "albedo", c, 0.0, 2.0, 0.01)
        for c, name in enumerate(("Deep scatter red", "green", "blue")):
            self.channel(name, "deep_scatter", c, 0.0, 3.0, 0.05)


class EyesPanel(Panel):
    name = "Eyes"

    def build(self) -> None:
        if not self.viewer.session.mesh.eyes:
            ui.label("This mesh has no eyes that the viewer knows; the heads of the package have.").classes("text-xs")
        self.slider("Pupil, mm", self.look, "pupil", 0.5, 4, 0.1)
        self.color("Iris", self.look, "iris_color", "iris-color")
        self.slider("Pattern of fibres", self.look, "iris_seed", 0, 20, 1)
        self.slider("Concave iris, mm", self.look, "iris_concavity", 0, 1, 0.05)
        self.select("Scattering in the iris", {"": "None", **{n: n for n in Profile.library_names()}}, "iris_profile")
        self.slider("Limbus, mm wide", self.look, "limbus_width", 0.1, 3, 0.05)
        self.slider("Its darkness", self.look, "limbus_darkening", 0, 1, 0.01)
        self.slider("Cornea's radius, mm", self.look, "cornea_radius", 7, 10, 0.05)
        self.slider("Depth of chamber, mm", self.look, "chamber_depth", 2.7, 4.5, 0.05)
        self.slider("Roughness of tears", self.look, "tear_roughness", 0.005, 0.3, 0.005)
        self.channel("Gaze, to its left", "gaze", 0, -40, 40, 1)
        self.channel("Gaze, up", "gaze", 1, -30, 30, 1)

        async def dropped(e: events.UploadEventArguments) -> None:
            path = self.viewer.keep(e.file.name, await e.file.read())
            try:
                await self.viewer.on_thread(lambda: iris_image(path))
            except Exception as error:  # the iris before it stays
                ui.notify(f"{e.file.name}: {error}", type="negative", multi_line=True, close_button=True, timeout=0)
                return
            self.look.iris_texture, self.look.iris_color = str(path), (1.0, 1.0, 1.0)
            self.page.build()
            self.viewer.changed()

        def fibres() -> None:
            self.look.iris_texture, self.look.iris_color = "", Look().iris_color
            self.page.build()
            self.viewer.changed()

        ui.upload(label="Drop a picture of an iris here", auto_upload=True, on_upload=dropped, max_file_size=1 << 28).props(
            "dense flat data-pel=iris-upload").classes("w-full")
        if self.look.iris_texture:
            ui.button("Fibres in its place", on_click=fibres).props("dense flat data-pel=iris-fibres").classes("w-full")


class LightsPanel(Panel):
    name = "Lights"

    def build(self) -> None:
        self.slider("Ambient", self.look, "ambient", 0, 1, 0.01)
        self.select("Shadow map, texels", [512, 1024, 2048, 4096], "shadow_size")
        for i, lamp in enumerate(self.look.lamps):
            self.switch(lamp.name, lamp, "on", f"lamp-{i}-on")
            self.slider("Intensity", lamp, "intensity", 0, 4, 0.05, f"lamp-{i}-intensity")
            self.slider("Azimuth", lamp, "azimuth", -180, 180, 1, f"lamp-{i}-azimuth")
            self.slider("Elevation", lamp, "elevation", -89, 89, 1, f"lamp-{i}-elevation")
            self.color("Colour", lamp, "color", f"lamp-{i}-color")
            self.switch("Shadow", lamp, "shadow", f"lamp-{i}-shadow")


class ProfilePanel(Panel):
    name = "Profile"

    def build(self) -> None:
        self.select("Profile", [*Profile.library_names(), "custom"], "profile", self.draw_profile)
        for c, name in enumerate(("custom: d red, mm", "green", "blue")):
            self.channel(name, "distance", c, 0.01, 5.0, 0.01, self.draw_profile)
        self.curve = ui.echart({
            "animation": False, "grid": {"left": 45, "right": 10, "top": 25, "bottom": 40}, "textStyle": {"color": "#ccc"},
            "title": {"text": "light by distance: 2πr R(r), 1/mm", "textStyle": {"fontSize": 11, "color": "#ccc"}},
            "xAxis": {"type": "value", "name": "mm", "nameLocation": "middle", "nameGap": 25}, "yAxis": {"type": "value"},
            "series": [{"type": "line", "showSymbol": False, "data": [], "lineStyle": {"color": c}} for c in ("#f66", "#6d6", "#69f")]}).style(
                "height:13rem;width:100%")
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
        def keep() -> None:
            self.viewer.session.other = self.look.copy()
            self.viewer.changed()

        def drop() -> None:
            self.viewer.session.other = None
            self.viewer.changed()

        def swap() -> None:
            s = self.viewer.session
            if s.other is not None:
                s.look, s.other = s.other, s.look
                self.page.build()
                self.viewer.changed()

        ui.label("Keeps the settings of now on the right of a line; change them on the left. Alt and drag moves the line.").classes("text-xs")
        with ui.row():
            ui.button("Keep", on_click=keep).props("dense data-pel=wipe-keep")
            ui.button("Swap", on_click=swap).props("dense data-pel=wipe-swap")
            ui.button("Drop", on_click=drop).props("dense data-pel=wipe-drop")
        self.slider("Line", self.viewer.session, "wipe", 0, 1, 0.01)
