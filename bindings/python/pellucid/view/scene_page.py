"""Panels for a scene file."""
from __future__ import annotations

import tempfile
from pathlib import Path

from nicegui import events, ui

from .._types import Scattering
from ..profile import Profile
from .scene_session import MODES
from .widgets import Panel


class ScenePanel(Panel):
    def build(self) -> None:
        self.select("Picture", MODES, "mode")
        self.slider("Exposure", self.look, "exposure", 0.1, 4, 0.05)
        self.select("Tone mapping", {"soft": "Soft", "none": "None", "filmic": "Filmic", "agx-like": "AgX-like"}, "curve")
        self.slider("Shoulder", self.look, "shoulder", 0.3, 1, 0.05)


class SceneMaterialsPanel(Panel):
    name, open = "Materials", True

    def build(self) -> None:
        scene = self.viewer.session.scene
        for id, material in scene.materials.items():
            ui.label(f"Material {id}").classes("text-sm")
            known = Profile.library_names()
            named = scene.profiles.get(id, "")

            def profile(e: events.ValueChangeEventArguments, id: int = id) -> None:
                scene.profiles[id] = e.value
                self.viewer.changed()

            ui.select([*([] if named in known else [named]), *known], label="Profile", value=named, on_change=profile).props(
                f"dense options-dense data-pel=profile-{id}").classes("w-full")
            self.select("Scattering", {s.name.lower(): s.name.capitalize() for s in Scattering}, "scattering", owner=material, marker=f"scattering-{id}")
            for label, field, low, high, step in (("Specular", "specular", 0, 1, 0.01), ("Roughness", "roughness", 0.05, 1, 0.01),
                                                  ("f0", "f0", 0, 0.2, 0.002), ("Transmission", "transmission", 0, 2, 0.05)):
                self.slider(label, material, field, low, high, step, f"{field}-{id}")


class SceneLightsPanel(Panel):
    name, open = "Lights", True

    def build(self) -> None:
        self.slider("Ambient, times", self.look, "ambient", 0, 4, 0.05)
        for i in range(len(self.look.lights)):
            self.element(f"Light {i + 1}, times", self.look, "lights", i, 0, 4, 0.05)


class SceneExportPanel(Panel):
    name = "Export"

    def build(self) -> None:
        async def scene() -> None:
            def make() -> bytes:
                # Beside the scene itself, so that files are named as there.
                with tempfile.NamedTemporaryFile(suffix=".toml", dir=Path(self.viewer.session.path).resolve().parent) as file:
                    self.viewer.session.save(file.name)
                    return Path(file.name).read_bytes()

            try:
                ui.download(await self.viewer.on_thread(make), "scene.toml")
            except Exception as error:
                ui.notify(f"{error}", type="negative", close_button=True, timeout=0)

        ui.button("Scene (.toml)", on_click=scene).props("dense data-pel=export-scene").classes("w-full")
