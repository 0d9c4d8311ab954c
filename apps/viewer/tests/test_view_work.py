"""Background work of the viewer: the reference's thread, units of meshes, closed pages."""
import asyncio
import threading
import time
import types

import numpy as np
import pytest
from view_session import reset

from pellucid.mesh import MeshTopology
from pellucid.shader import Shader
from pellucid.view.export import export
from pellucid.view.passes import Pass
from pellucid.view.reference import Reference, vertex_irradiance
from pellucid.view.session import Session
from pellucid.view.widgets import Panel


def wait_until(condition, seconds=120):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_the_reference_leaves_the_session_free(session):
    session.look.mode = "reference"
    whole = session.frame(96, 54).pixels  # without `report` it is complete at once
    session.cancel_reference("main")
    reports, gate = [], threading.Event()

    def report():
        reports.append(threading.current_thread().name)
        gate.wait(60)

    session.report = report
    try:
        first = session.frame(96, 54).pixels
        wait_until(lambda: reports)
        assert "%" in session.work and set(reports) == {"pellucid-reference"}
        session.look.pores = 0.0
        session.look.mode = "final"
        other = session.frame(120, 68).pixels  # while the reference waits
        assert other.any() and session.work == "" and not np.array_equal(first, whole)
        gate.set()
        session.look.mode = "reference"
        session.frame(96, 54)
        made = session.references["main"]
        wait_until(lambda: made.fraction == 1)
        assert np.array_equal(session.frame(96, 54).pixels, whole) and session.references["main"] is made
        session.cancel_reference("main")
        assert np.array_equal(session.still().frame(96, 54).pixels, whole) and not session.references
        session.frame(96, 54)
        made = session.references["main"]
        moving = session.frame(96, 54, small=True).pixels
        assert session.references["main"] is made and not np.array_equal(moving, whole)
    finally:
        gate.set()


@pytest.mark.parametrize("late", ["curvature", "commit"])
def test_a_first_picture_waits_for_no_kernel(session, monkeypatch, late):
    kind = MeshTopology if late == "curvature" else Shader
    gate, real = threading.Event(), getattr(kind, late)

    def waits(*arguments, **options):
        gate.wait(60)
        return real(*arguments, **options)

    monkeypatch.setattr(kind, late, waits)
    own = Session(session.device)
    own.report = lambda: None
    try:
        own.show(session.mesh)
        assert own.measuring == (late == "curvature")
        own.orbit = session.orbit
        first = own.frame(192, 108)
        again = own.frame(96, 54)  # of another size, meanwhile
        assert first.stands_in and again.stands_in and again.pixels.shape == (54, 96, 3)
    finally:
        gate.set()
    wait_until(lambda: not own.frame(192, 108).stands_in)
    session.look.mode = "lambert"
    plain, whole = session.frame(192, 108).pixels.astype(int), first.pixels.astype(int)
    assert ((plain > 0).any(2) == (whole > 0).any(2)).mean() > 0.999
    assert np.abs(plain - whole).mean() < 2  # without gloss, and the edges of shadows
    reset(session)
    assert np.array_equal(own.frame(192, 108).pixels, session.frame(192, 108).pixels)
    assert np.array_equal(own.gbuffer(192, 108).curvature, session.gbuffer(192, 108).curvature)


def test_what_is_written_waits_for_its_kernels(session, monkeypatch, tmp_path):
    own, standing, real = Session(session.device), [], Pass.shade
    own.report = lambda: None
    own.show(session.mesh)

    def shade(self, *rest):
        made = real(self, *rest)
        standing.append(self.stands_in or own.background)
        return made

    monkeypatch.setattr(Pass, "shade", shade)
    export(own, tmp_path, 96, 54)
    own.smooth(96, 54)
    assert len(standing) > 8 and not any(standing) and own.background


def test_the_reference_has_the_light_of_the_lamps(session):
    look = session.look
    look.ambient, look.surroundings = 0.0, ""
    for lamp in look.lamps:
        lamp.on, lamp.color, lamp.intensity = lamp is look.lamps[0], (1.0, 0.5, 0.25), 0.8
    light = vertex_irradiance(session, look)
    assert light.max() == pytest.approx(0.8, abs=0.02)
    assert np.allclose(light * (1, 2, 4), light[:, :1], atol=1e-6)


def test_the_reference_follows_the_pigments(session):
    session.look.mode, session.look.profile = "reference", "pigments"
    before = session.frame(96, 54).pixels
    session.look.blood = 0.2
    assert not np.array_equal(session.frame(96, 54).pixels, before)


def test_a_reference_is_coarse_first_and_can_be_cancelled():
    points = np.zeros((40, 60, 3), np.float32)
    points[..., 0], points[..., 1] = np.meshgrid(np.arange(60), np.arange(40))
    seen = points[..., 0] >= 8
    right = np.where(seen[..., None], points + 1, 0)
    sizes, pieces = [], []

    def compute(p):
        sizes.append(len(p))
        return p + 1

    done = Reference("key", compute, points, seen)
    done.start(None)
    assert np.array_equal(done.picture(), right) and done.fraction == 1
    assert sizes[0] == 5 * 7  # every eighth pixel of every eighth row
    stopped = Reference("key", compute, points, seen)
    stopped._run(lambda: (pieces.append(stopped.fraction), stopped.cancel()), 1024)
    picture = stopped.picture()
    assert np.array_equal(picture[::8, ::8], right[::8, ::8])
    assert pieces == [5 * 7 / seen.sum(), 1]  # the piece, and the end
    assert np.array_equal(picture[9, 20], points[8, 16] + 1)  # the nearest known pixel above on the left
    failed = Reference("key", lambda p: 1 / 0, points, seen)
    failed.start(None)
    with pytest.raises(ZeroDivisionError):
        failed.picture()


@pytest.mark.parametrize("scale, better", [(1e-3, 1000.0), (0.1, 10.0), (1.0, None), (100.0, None)])
def test_a_mesh_of_another_unit_is_noticed(session, tmp_path, scale, better):
    corners = 240 * scale * np.array([[0, 0, 0], [0.7, 0, 0], [0, 1, 0], [0, 0, 0.8]])
    faces = ["3 0 2 1", "3 0 1 3", "3 0 3 2", "3 1 2 3"]
    mesh = tmp_path / "mesh.off"
    mesh.write_text("OFF\n4 4 0\n" + "\n".join(" ".join(map(repr, map(float, c))) for c in corners) + "\n" +
                    "\n".join(faces) + "\n")
    own = Session(session.device)
    own.load(mesh)
    if scale == 100.0:  # of a tenth of a millimetre: no unit in use
        own.set_unit(0.01)
    assert own.better_unit() == better
    if better is not None:
        before = own.orbit
        own.set_unit(better)
        assert own.better_unit() is None and own.size() == pytest.approx(240, rel=1e-3)
        assert own.orbit is before
        assert own.renderer._mm == better


def test_a_file_for_a_closed_page_is_dropped(monkeypatch):
    """The export of a page closed meanwhile ends without a traceback; one that fails says so on its page."""
    from nicegui import Client, core, ui
    from nicegui.page import page

    given, shown, closing = [], [], []
    monkeypatch.setattr(ui, "download", lambda data, name: given.append(name))
    monkeypatch.setattr(ui, "notify", lambda text, **_: shown.append(text))
    changes = []

    async def on_thread(work):
        if closing:
            closing.pop().delete()
        return work()

    def fails():
        raise OSError("the disk is full")

    async def run():
        core.loop = asyncio.get_running_loop()
        viewer = types.SimpleNamespace(on_thread=on_thread, changed=lambda: changes.append(1))
        panel = Panel(types.SimpleNamespace(viewer=viewer))
        client = Client(page("/"))
        with client:
            await panel.deliver(lambda: b"", "closed.zip")
            await panel.deliver(fails, "failed.zip")
        gone = Client(page("/"))
        with gone:
            closing.append(gone)
            await panel.deliver(fails, "gone.zip")

    asyncio.run(run())
    assert given == [] and shown[:1] == ["the disk is full"] and len(changes) == 3
