"""Undo, the probe, the pivot, false colours, comparing side by side, and what is kept between two runs."""
import json

import numpy as np
import pytest

pytest.importorskip("moderngl", reason="moderngl is not installed")
files = pytest.importorskip("pellucid.files", reason="this build reads no files")
from view_session import reset  # noqa: E402

from pellucid.view.history import History  # noqa: E402
from pellucid.view.look import Look  # noqa: E402
from pellucid.view.memory import Memory, recall, remember  # noqa: E402
from pellucid.view.pictures import LUMINANCE, SCALE, histogram  # noqa: E402
from pellucid.view.probe import describe_pixel, place  # noqa: E402
from pellucid.view.session import Session  # noqa: E402


@pytest.fixture
def fresh(session):
    reset(session)
    yield session
    reset(session)


def test_each_gesture_is_one_step_back_and_forth(fresh):
    history = History(fresh)
    assert not history.undo(fresh) and not history.redo(fresh)
    for i, roughness in enumerate((0.2, 0.3, 0.4)):  # one drag
        fresh.look.roughness = roughness
        history.note(fresh, 10 + 0.1 * i)
    fresh.look.lamps[1].azimuth = 12.0
    history.note(fresh, 20)
    fresh.orbit.azimuth = 77.0
    history.note(fresh, 30)
    history.note(fresh, 40)  # nothing changed: no step
    seen = []
    while history.undo(fresh):
        seen.append((fresh.orbit.azimuth, fresh.look.lamps[1].azimuth, fresh.look.roughness))
    assert seen == [(20.0, 12.0, 0.4), (20.0, -50.0, 0.4), (20.0, -50.0, Look().roughness)]
    assert history.redo(fresh) and fresh.look.roughness == 0.4
    fresh.look.roughness = 0.9  # another way on
    history.note(fresh, 50)
    assert not history.redo(fresh)
    assert history.undo(fresh) and fresh.look.roughness == 0.4


def test_the_probe_names_what_the_pixel_holds(fresh):
    fresh.frame(320, 180)
    rows, columns = np.nonzero(fresh.shown.material == 1)
    row, column = rows[len(rows) // 2], columns[len(columns) // 2]
    x, y = (column + 0.5) / 320, (row + 0.5) / 180
    facts = describe_pixel(fresh, x, y)
    assert facts.startswith(f"skin, column {column}, row {row}\n")
    radiance = fresh.radiance(width=320, height=180)[row, column]
    assert "radiance {:.4f}, {:.4f}, {:.4f}".format(*radiance) in facts
    cosine = fresh.shown.normal_shading[row, column] @ fresh.to_light(fresh.look.lamps[0])
    assert f"N·L of the key light {cosine:.3f}" in facts and "scattering: screen" in facts
    for nowhere in ((0.001, 0.001), (1.5, 0.5), (-0.1, 0.5), (0.5, float("nan"))):
        assert describe_pixel(fresh, *nowhere) == ""


def test_the_camera_turns_about_the_pivot(fresh):
    fresh.frame(320, 180)
    rows, columns = np.nonzero(fresh.shown.material == 1)
    row, column = rows[len(rows) // 5], columns[len(rows) // 5]
    at = place(fresh, (column + 0.5) / 320, (row + 0.5) / 180)
    fresh.orbit.pivot = tuple(at - fresh.centre)
    for azimuth, elevation in ((20, 2), (35, 10)):  # it stays in the middle
        fresh.orbit.azimuth, fresh.orbit.elevation = azimuth, elevation
        clip = fresh.camera(16 / 9)[1] @ [*at, 1.0]
        np.testing.assert_allclose(clip[:2] / clip[3], 0, atol=1e-6)
        distance = np.linalg.norm(fresh.camera(16 / 9)[0] - at)
        assert distance == pytest.approx(fresh.orbit.distance)
    assert place(fresh, 0.001, 0.001) is None


def test_false_colours_show_luminance(fresh):
    radiance = fresh.radiance(width=160, height=90)
    fresh.look.mode, fresh.look.white = "false_color", 0.5
    shown = fresh.frame(160, 90).pixels.astype(int)
    first, last = ([int(SCALE[i][c:c + 2], 16) for c in (1, 3, 5)] for i in (0, -1))
    luminance, seen = radiance @ LUMINANCE, fresh.shown.material > 0
    assert (shown[~seen] == 0).all() and (luminance[seen] > 0.5).any()
    assert (shown[seen & (luminance > 0.5)] == last).all()
    middle = np.argmin(np.abs(luminance - 0.25))
    expected = [int(SCALE[4][c:c + 2], 16) for c in (1, 3, 5)]
    assert np.abs(shown.reshape(-1, 3)[middle] - expected).max() <= 4
    assert np.abs(shown[seen & (luminance < 0.002)] - first).max(initial=0) <= 2


def test_the_histogram_counts_what_is_seen():
    pixels = np.zeros((4, 4, 3), np.uint8)
    pixels[0] = 255, 0, 7
    assert [sum(channel) for channel in histogram(pixels)] == [4, 4, 4]
    red, green, blue = histogram(pixels)
    assert red[63] == green[0] == blue[1] == 4


def test_another_method_on_the_right_and_side_by_side(fresh):
    fresh.against = "none"
    other = fresh.look.copy()
    other.method = "none"
    both = fresh.frame(200, 90).pixels
    fresh.against, fresh.other = "", other
    np.testing.assert_array_equal(fresh.frame(200, 90).pixels, both)
    fresh.beside = True
    pair = fresh.frame(200, 90).pixels
    fresh.other = fresh.beside = None
    left = fresh.frame(100, 90).pixels
    fresh.look = other
    right = fresh.frame(100, 90).pixels
    np.testing.assert_array_equal(pair[:, :99], left[:, :99])
    np.testing.assert_array_equal(pair[:, 101:], right[:, 1:])


def test_presets_and_what_was_open_come_back(fresh, tmp_path):
    path = tmp_path / "there" / "view.json"
    memory = Memory(path)
    assert recall(memory, fresh) == "" and not memory.problem
    fresh.look.roughness, fresh.orbit.azimuth, fresh.orbit.pivot = 0.77, 64.0, (1.0, 2.0, 3.0)
    other = Memory(path)
    memory.update(presets={"Mine": fresh.look.to_dict(), "Old": {}})
    memory.update(presets={"Old": None})
    other.opened["Skin"] = True
    remember(other, fresh)  # another viewer's presets stay
    assert [p.name for p in path.parent.iterdir()] == ["view.json"]
    again = Memory(path)
    assert list(again.part("presets")) == ["Mine"] and again.opened == {"Skin": True}
    elsewhere = Memory(path)
    elsewhere.update(last={"mesh": str(tmp_path / "dropped.obj")})
    session = Session(fresh.device)
    assert recall(elsewhere, session) == "" and session.look == fresh.look
    session = Session(fresh.device)
    assert recall(again, session) == str(files.standard_head())
    assert session.look == fresh.look == Look.from_dict(again.part("presets")["Mine"])
    assert session.orbit == fresh.orbit and len(session.mesh.positions) == len(fresh.mesh.positions)
    # Flags come before what is remembered, and are remembered like it, also when the next run has none.
    flagged, later = Session(fresh.device), Session(fresh.device)
    assert recall(again, flagged, up="z", subdivide=0, mm=10) == str(files.standard_head())
    remember(again, flagged)
    assert recall(Memory(path), later) == str(files.standard_head()) and later.mm == 10
    assert later.read == {"subdivide": 0, "up": "z"}
    np.testing.assert_array_equal(later.mesh.positions, flagged.mesh.positions)
    assert len(later.mesh.positions) < len(session.mesh.positions)


@pytest.mark.parametrize("text", ["{", "[]", '{"last": 3}',
                                  '{"last": {"mesh": "HEAD", "look": {"roughnes": 1}}}',
                                  '{"last": {"mesh": "HEAD", "look": {}, "orbit": {}, "mm": "x"}}',
                                  '{"last": {"mesh": "HEAD", "look": [], "orbit": {}, "mm": 1}}',
                                  '{"last": {"mesh": "HEAD", "look": {}, "orbit": [], "mm": 1}}',
                                  '{"last": {"mesh": "HEAD.gone", "look": {}, "orbit": {}, "mm": 1}}',
                                  '{"last": {"mesh": "BAD", "look": {}, "orbit": {}, "mm": 1000}}'])
def test_a_damaged_memory_is_no_obstacle(fresh, tmp_path, text):
    path = tmp_path / "view.json"
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nf 1 2 3\n")
    path.write_text(text.replace("HEAD", str(files.standard_head())).replace("BAD", str(bad)))
    memory = Memory(path)
    assert bool(memory.problem) == (text in ("{", "[]"))
    look = fresh.look.copy()
    assert recall(memory, fresh) == "" and fresh.look == look and fresh.mm == 1
    memory.update(presets={"Mine": look.to_dict()})
    assert json.loads(path.read_text())["presets"]["Mine"]["roughness"] == look.roughness
