"""The viewer's controls without a browser: what the guide lists is there, and sets the look."""
import asyncio
import json
import re
import tempfile
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("moderngl", reason="moderngl is not installed")
nicegui = pytest.importorskip("nicegui", reason="nicegui is not installed")
pytest.importorskip("pellucid.files", reason="this build reads no files")
from nicegui import Client, core, ui  # noqa: E402
from nicegui.page import page  # noqa: E402
from view_session import reset  # noqa: E402

import pellucid  # noqa: E402
from pellucid._types import MaterialValues  # noqa: E402
from pellucid.view.export import export  # noqa: E402
from pellucid.view.history import History  # noqa: E402
from pellucid.view.look import Lamp, Look  # noqa: E402
from pellucid.view.memory import Memory  # noqa: E402
from pellucid.view.page import Page  # noqa: E402
from pellucid.view.scene_session import MODES, SceneSession  # noqa: E402
from pellucid.view.server import Viewer  # noqa: E402


class Shown:
    """What a page asks of a viewer."""

    def __init__(self, session, folder):
        self.session, self.last, self.changes = session, None, 0
        self.memory, self.histogram, self.pages = Memory(Path(folder) / "view.json"), False, set()

    rebuild = Viewer.rebuild

    def changed(self, moving=False):
        self.changes += 1


def opened(session, act):
    """Calls act(elements, viewer) on a page of this session."""
    async def run(folder):
        core.loop = asyncio.get_running_loop()
        client, viewer = Client(page("/")), Shown(session, folder)
        with client:
            Page(viewer)
            act(list(client.elements.values()), viewer)

    with tempfile.TemporaryDirectory() as folder:
        asyncio.run(run(folder))


@pytest.fixture
def fresh(session):
    reset(session)
    session.count, session.wipe = False, 0.5
    return session


def marked(elements, kind):
    return {e.props["data-pel"]: e for e in elements if isinstance(e, kind) and "data-pel" in e.props}


def label(slider):
    return next(e.text for e in slider.parent_slot.children if isinstance(e, ui.label) and e.text)


def test_the_guide_lists_every_slider_with_its_limits(fresh):
    text = (Path(__file__).parents[3] / "docs/guide/viewer.md").read_text(encoding="utf-8")
    listed = [row for row in re.findall(r"^\| (.+?) \| ([-\d.]+) \| ([-\d.]+) \| ([-\d.]+) \|$", text, re.M)]
    shown = []

    def look(elements, viewer):
        for e in marked(elements, ui.slider).values():
            row = (label(e), *(f"{e.props[k]:g}" for k in ("min", "max", "step")))
            if row not in shown:  # three lamps have the same ones
                shown.append(row)

    opened(fresh, look)
    assert listed == shown


def test_every_control_sets_the_value_that_it_names(fresh):
    def act(elements, viewer):
        look = fresh.look
        fallow = {f.name for f in fields(Look)} - {"lamps", "iris_texture", "profile"}
        fallow |= {(str(i), f.name) for i in range(len(look.lamps)) for f in fields(Lamp)
                   if f.name != "name"}
        for name, e in marked(elements, ui.slider).items():
            lamp, channel = re.match(r"slider-lamp-(\d)-(\w+)", name), re.match(r"slider-(\w+)-(\d)", name)

            def value(name=name, lamp=lamp, channel=channel):
                if lamp:
                    return getattr(look.lamps[int(lamp[1])], lamp[2])
                if name == "slider-wipe":
                    return fresh.wipe
                if channel:
                    return getattr(look, channel[1])[int(channel[2])]
                return getattr(look, name[len("slider-"):])

            low, high = e.props["min"], e.props["max"]
            assert low <= value() <= high and low < high, name
            assert e.value == value(), name
            order = (low, high) if value() == high else (high, low)
            for wanted in (*order, order[0]):
                e.set_value(wanted)
                assert value() == wanted and viewer.changes, name
                viewer.changes = 0
            fallow.discard(lamp.groups() if lamp else channel[1] if channel else name[len("slider-"):])
        for name, e in marked(elements, ui.switch).items():
            lamp = re.match(r"lamp-(\d)-(\w+)", name)
            of, field = (look.lamps[int(lamp[1])], lamp[2]) if lamp else (
                {"count": fresh, "beside": fresh, "histogram": viewer}.get(name, look), name)
            for wanted in (not getattr(of, field), getattr(of, field)):
                e.set_value(wanted)
                assert getattr(of, field) is wanted and viewer.changes, name
                viewer.changes = 0
            fallow.discard(lamp.groups() if lamp else field)
        for name, e in marked(elements, ui.color_input).items():
            lamp = re.match(r"lamp-(\d)-(\w+)", name)
            of, field = (look.lamps[int(lamp[1])], lamp[2]) if lamp else (look, name.replace("-", "_"))
            e.set_value("#ff8000")
            assert getattr(of, field) == pytest.approx((1.0, 0.2159, 0.0), abs=1e-4), name
            fallow.discard(lamp.groups() if lamp else field)
        for name, e in marked(elements, ui.select).items():
            if name in ("preset", "unit", "arrangement"):
                continue
            for wanted in e.options:
                e.set_value(wanted)
                assert getattr(fresh if name == "against" else look, name) == wanted, name
            fallow.discard(name)
        assert not fallow, "values that no control sets"

    opened(fresh, act)


def test_a_preset_sets_the_material_and_keeps_the_light(fresh):
    def act(elements, viewer):
        fresh.look.ambient, fresh.look.exposure, fresh.look.specular = 0.7, 2.0, 0.9
        marked(elements, ui.select)["preset"].set_value("Jade")
        assert fresh.look.profile == "jade" and fresh.look.specular == 0.6
        assert (fresh.look.ambient, fresh.look.exposure) == (0.7, 2.0)

    opened(fresh, act)


def test_every_page_sets_what_is_shown_after_a_preset_on_another_one(fresh):
    def act(elements, viewer):
        client = Client(page("/"))
        with client:
            Page(viewer)
        marked(elements, ui.select)["preset"].set_value("Jade")
        marked(client.elements.values(), ui.slider)["slider-roughness"].set_value(0.7)
        assert fresh.look.profile == "jade" and fresh.look.roughness == 0.7

    opened(fresh, act)


def test_presets_of_ones_own_are_saved_and_deleted(fresh):
    def act(elements, viewer):
        client = elements[0].client
        for button, there in (("own-save", True), ("own-delete", False)):
            shown = list(client.elements.values())
            marked(shown, ui.input)["own-name"].set_value("Mine")
            for listener in list(marked(shown, ui.button)[button]._event_listeners.values()):
                listener.handler(None)
            offered = marked(client.elements.values(), ui.select)["preset"].options
            kept = json.loads(viewer.memory.path.read_text())["presets"]
            assert ("Mine" in offered, "Mine" in kept) == (there, there)

    opened(fresh, act)


def test_skin_by_its_pigments_sets_profile_and_albedo_and_the_page_shows_them(fresh):
    def act(elements, viewer):
        sliders, selects = marked(elements, ui.slider), marked(elements, ui.select)
        sliders["slider-melanin"].set_value(0.2)
        assert fresh.look.profile == selects["profile"].value == "pigments"
        for c in range(3):
            assert sliders[f"slider-albedo-{c}"].value == fresh.look.albedo[c] < 0.5
        dark = fresh.profile(fresh.look).info
        assert dark.kind == pellucid.ProfileKind.SKIN_LAYERS
        sliders["slider-melanin"].set_value(0.02)
        assert sliders["slider-albedo-0"].value > 0.5
        assert fresh.profile(fresh.look).info.width[0] > dark.width[0]
        selects["profile"].set_value("jade")
        assert fresh.look.profile == "jade"
        sliders["slider-albedo-0"].set_value(0.1)
        selects["profile"].set_value("pigments")  # as the sliders are
        assert selects["profile"].value == "pigments" and fresh.look.albedo[0] > 0.5
        selects["preset"].set_value("Skin, very dark")
        assert fresh.look.melanin == 0.134 and fresh.look.albedo[0] < 0.4

    opened(fresh, act)


def test_a_scene_has_controls_too(fresh, tmp_path):
    export(fresh, tmp_path, 96, 54)
    shown = SceneSession(tmp_path / "scene.toml", device=fresh.device)

    def act(elements, viewer):
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

    opened(shown, act)
