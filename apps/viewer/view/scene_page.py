"""Panels for a scene file."""
from __future__ import annotations

import functools
import tempfile
from dataclasses import fields
from pathlib import Path

from nicegui import events, ui

from .._types import MaterialValues, Scattering
from ..profile import Profile
from .panels import tone_mapping
from .scene_session import MODES
from .widgets import Panel


class ScenePanel(Panel):
    def build(self) -> None:
        self.select("Picture", MODES, "mode")
        tone_mapping(self)


class SceneMaterialsPanel(Panel):
    name, open = "Materials", True

    def build(self) -> None:
        session = self.viewer.session
        for id, material in session.materials.items():
            ui.label(f"Material {id}").classes("text-sm")
            known = Profile.library_names()
            named = session.profiles.get(id, "")

            def profile(e: events.ValueChangeEventArguments, id: int = id) -> None:
                session.profiles[id] = e.value
                self.viewer.changed()

            names = known if named in known else [named, *known]
            ui.select(names, label="Profile", value=named, on_change=profile).props(
                f"dense options-dense data-pel=profile-{id}").classes("w-full")
            self.select("Scattering", {s.name.lower(): s.name.capitalize() for s in Scattering}, "scattering",
                        owner=material, marker=f"scattering-{id}")
            for value in fields(MaterialValues):
                self.field(value.name, material, marker=f"{value.name}-{id}")


class SceneLightsPanel(Panel):
    name, open = "Lights", True

    def build(self) -> None:
        self.slider("Ambient scale", self.look, "ambient", 0, 4, 0.05)
        for i in range(len(self.look.lights)):
            self.slider(f"Light {i + 1} scale", self.look, "lights", 0, 4, 0.05, index=i)


class SceneExportPanel(Panel):
    name = "Export"

    def build(self) -> None:
        def make() -> bytes:
            # Beside the scene itself, so that relative paths stay valid.
            folder = Path(self.viewer.session.path).resolve().parent
            with tempfile.NamedTemporaryFile(suffix=".toml", dir=folder) as file:
                self.viewer.session.save(file.name)
                return Path(file.name).read_bytes()

        self.button("Scene (.toml)", functools.partial(self.deliver, make, "scene.toml"), "export-scene")
