"""The viewer's controls without a browser: what the guide lists is there, and sets the look."""
import asyncio
import contextlib
import json
import re
import tempfile
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from nicegui import Client, core, ui
from nicegui.page import page

import pellucid
from pellucid._types import MaterialValues
from pellucid.view.export import export
from pellucid.view.history import History
from pellucid.view.look import Lamp, Look
from pellucid.view.memory import Memory
from pellucid.view.page import Page
from pellucid.view.scene_session import MODES, SceneSession
from pellucid.view.server import Viewer


class Shown:
    """What a page asks of a viewer."""

    def __init__(self, session, folder):
        self.session, self.last, self.changes = session, None, 0
        self.memory, self.histogram, self.pages = Memory(Path(folder) / "view.json"), False, set()

    rebuild = Viewer.rebuild

    def changed(self, moving=False):
        self.changes += 1


@contextlib.contextmanager
def opened(session):
    """The elements of a page of this session, and its viewer."""
    core.loop = asyncio.new_event_loop()
    with tempfile.TemporaryDirectory() as folder, Client(page("/")) as client:
        viewer = Shown(session, folder)
        Page(viewer)
        yield list(client.elements.values()), viewer
    core.loop.close()


def marked(elements, kind):
    return {e.props["data-pel"]: e for e in elements if isinstance(e, kind) and "data-pel" in e.props}


def label(slider):
    return next(e.text for e in slider.parent_slot.children if isinstance(e, ui.label) and e.text)


def test_the_guide_lists_every_slider_with_its_limits(session):
    text = (Path(__file__).parents[3] / "docs/guide/viewer.md").read_text(encoding="utf-8")
    listed = [row for row in re.findall(r"^\| (.+?) \| ([-\d.]+) \| ([-\d.]+) \| ([-\d.]+) \|$", text, re.M)]
    with opened(session) as (elements, viewer):
        shown = [(label(e), *(f"{e.props[k]:g}" for k in ("min", "max", "step")))
                 for e in marked(elements, ui.slider).values()]
    assert listed == list(dict.fromkeys(shown))  # three lamps have the same ones


def test_every_control_sets_the_value_that_it_names(session):
    with opened(session) as (elements, viewer):
        look = session.look
        fallow = {(id(look), f.name) for f in fields(Look)} | {
            (id(lamp), f.name) for lamp in look.lamps for f in fields(Lamp) if f.name != "name"}
        fallow -= {(id(look), name) for name in ("lamps", "iris_texture", "profile")}
        others = {"histogram": viewer, **dict.fromkeys(("against", "beside", "count", "wipe"), session)}

        def value(name):
            """Of what a control sets."""
            lamp, channel = re.fullmatch(r"lamp-(\d)-(\w+)", name), re.fullmatch(r"(\w+)-(\d)", name)
            owner = look.lamps[int(lamp[1])] if lamp else others.get(name, look)
            field = lamp[2] if lamp else channel[1] if channel else name.replace("-", "_")
            fallow.discard((id(owner), field))
            found = getattr(owner, field)
            return found[int(channel[2])] if channel else found

        def set_to(wanted, name, e):
            viewer.changes = 0
            e.set_value(wanted)
            assert value(name) == wanted and viewer.changes, name

        for marker, e in marked(elements, ui.slider).items():
            name, low, high = marker.removeprefix("slider-"), e.props["min"], e.props["max"]
            assert low <= e.value == value(name) <= high and low < high, name
            order = (low, high) if e.value == high else (high, low)
            for wanted in (*order, order[0]):
                set_to(wanted, name, e)
        for name, e in marked(elements, ui.switch).items():
            for wanted in (not value(name), value(name)):
                set_to(wanted, name, e)
        for name, e in marked(elements, ui.color_input).items():
            e.set_value("#ff8000")
            assert value(name) == pytest.approx((1.0, 0.2159, 0.0), abs=1e-4), name
        for name, e in marked(elements, ui.select).items():
            if name not in ("preset", "unit", "arrangement"):
                for wanted in e.options:
                    e.set_value(wanted)
                    assert value(name) == wanted, name
        assert not fallow, "values that no control sets"


def test_a_preset_sets_the_material_of_every_page_and_keeps_the_light(session):
    with opened(session) as (elements, viewer):
        with Client(page("/")) as other:
            Page(viewer)
        session.look.ambient, session.look.exposure, session.look.specular = 0.7, 2.0, 0.9
        marked(elements, ui.select)["preset"].set_value("Jade")
        assert session.look.profile == "jade" and session.look.specular == 0.6
        assert (session.look.ambient, session.look.exposure) == (0.7, 2.0)
        marked(other.elements.values(), ui.slider)["slider-roughness"].set_value(0.7)
        assert session.look.profile == "jade" and session.look.roughness == 0.7


def test_presets_of_ones_own_are_saved_and_deleted(session):
    with opened(session) as (elements, viewer):
        client = elements[0].client
        for button, there in (("own-save", True), ("own-delete", False)):
            shown = list(client.elements.values())
            marked(shown, ui.input)["own-name"].set_value("Mine")
            for listener in list(marked(shown, ui.button)[button]._event_listeners.values()):
                listener.handler(None)
            offered = marked(client.elements.values(), ui.select)["preset"].options
            kept = json.loads(viewer.memory.path.read_text())["presets"]
            assert ("Mine" in offered, "Mine" in kept) == (there, there)


def test_skin_by_its_pigments_sets_profile_and_albedo_and_the_page_shows_them(session):
    with opened(session) as (elements, viewer):
        sliders, selects = marked(elements, ui.slider), marked(elements, ui.select)
        sliders["slider-melanin"].set_value(0.2)
        assert session.look.profile == selects["profile"].value == "pigments"
        for c in range(3):
            assert sliders[f"slider-albedo-{c}"].value == session.look.albedo[c] < 0.5
        dark = session.profile(session.look).info
        assert dark.kind == pellucid.ProfileKind.SKIN_LAYERS
        sliders["slider-melanin"].set_value(0.02)
        assert sliders["slider-albedo-0"].value > 0.5
        assert session.profile(session.look).info.width[0] > dark.width[0]
        selects["profile"].set_value("jade")
        assert session.look.profile == "jade"
        sliders["slider-albedo-0"].set_value(0.1)
        selects["profile"].set_value("pigments")  # as the sliders are
        assert selects["profile"].value == "pigments" and session.look.albedo[0] > 0.5
        selects["preset"].set_value("Skin, very dark")
        assert session.look.melanin == 0.134 and session.look.albedo[0] < 0.4


def test_a_scene_has_controls_too(session, tmp_path):
    export(session, tmp_path, 96, 54)
    shown = SceneSession(tmp_path / "scene.toml", device=session.device)
    with opened(shown) as (elements, viewer):
        scene, look = shown.scene, shown.look
        sliders, selects = marked(elements, ui.slider), marked(elements, ui.select)
        of_materials = {f"slider-{f.name}-{id}": (scene.materials[id], f.name)
                        for f in fields(MaterialValues) for id in scene.materials}
        assert sliders.keys() == {f"slider-{name}" for name in (
            "ambient", "exposure", "shoulder", *(f"lights-{i}" for i in range(3)))} | of_materials.keys()
        for name, slider in sliders.items():
            wanted = 0.3 * slider.props["min"] + 0.7 * slider.props["max"]
            slider.set_value(wanted)
            of, field = of_materials.get(name, (look, name[len("slider-"):]))
            found = look.lights[int(field[-1])] if field.startswith("lights") else getattr(of, field)
            assert found == pytest.approx(wanted), name
        assert selects.keys() == {"mode", "curve", *(f"{name}-{id}" for name in ("profile", "scattering")
                                                     for id in scene.materials)}
        for id in scene.materials:
            selects[f"profile-{id}"].set_value("jade")
            selects[f"scattering-{id}"].set_value("light")
            assert scene.profiles[id] == "jade" and scene.materials[id].scattering.name == "LIGHT"
        assert list(selects["mode"].options) == list(MODES) and "export-scene" in marked(elements, ui.button)
        assert viewer.changes == len(sliders) + 2 * len(scene.materials)
        kept, material = History(shown), scene.materials[id]
        before = material.roughness
        material.roughness, scene.profiles[id] = 0.11, "marble"
        kept.note(shown)
        assert kept.undo(shown) and material.roughness == before and scene.profiles[id] == "jade"
        assert kept.redo(shown) and material.roughness == np.float32(0.11) and scene.profiles[id] == "marble"
