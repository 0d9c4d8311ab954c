"""Undo, the probe, the pivot, false colours, comparing side by side, and what is kept between two runs."""
import json

import numpy as np
import pytest
from view_session import files

from pellucid.view.history import History
from pellucid.view.look import Look
from pellucid.view.memory import Memory, recall, remember
from pellucid.view.pictures import LUMINANCE, SCALE, histogram
from pellucid.view.probe import describe_pixel, place
from pellucid.view.session import Session


def test_each_gesture_is_one_step_back_and_forth(session):
    history = History(session)
    assert not history.undo(session) and not history.redo(session)
    for i, roughness in enumerate((0.2, 0.3, 0.4)):  # one drag
        session.look.roughness = roughness
        history.note(session, 10 + 0.1 * i)
    session.look.lamps[1].azimuth = 12.0
    history.note(session, 20)
    session.orbit.azimuth = 77.0
    history.note(session, 30)
    history.note(session, 40)  # nothing changed: no step
    seen = []
    while history.undo(session):
        seen.append((session.orbit.azimuth, session.look.lamps[1].azimuth, session.look.roughness))
    assert seen == [(20.0, 12.0, 0.4), (20.0, -50.0, 0.4), (20.0, -50.0, Look().roughness)]
    assert history.redo(session) and session.look.roughness == 0.4
    session.look.roughness = 0.9  # another way on
    history.note(session, 50)
    assert not history.redo(session)
    assert history.undo(session) and session.look.roughness == 0.4


def test_the_probe_names_what_the_pixel_holds(session):
    session.frame(320, 180)
    rows, columns = np.nonzero(session.shown.material == 1)
    row, column = rows[len(rows) // 2], columns[len(columns) // 2]
    x, y = (column + 0.5) / 320, (row + 0.5) / 180
    facts = describe_pixel(session, x, y)
    assert facts.startswith(f"skin, column {column}, row {row}\n")
    radiance = session.radiance(width=320, height=180)[row, column]
    assert "radiance {:.4f}, {:.4f}, {:.4f}".format(*radiance) in facts
    cosine = session.shown.normal_shading[row, column] @ session.to_light(session.look.lamps[0])
    assert f"N·L of the key light {cosine:.3f}" in facts and "scattering: screen" in facts
    session.set_unit(1000.0)
    try:
        assert "leaves this tile as it is" in describe_pixel(session, x, y)
    finally:
        session.set_unit(1.0)
    for nowhere in ((0.001, 0.001), (1.5, 0.5), (-0.1, 0.5), (0.5, float("nan"))):
        assert describe_pixel(session, *nowhere) == ""


def test_the_camera_turns_about_the_pivot(session):
    session.frame(320, 180)
    rows, columns = np.nonzero(session.shown.material == 1)
    row, column = rows[len(rows) // 5], columns[len(rows) // 5]
    at = place(session, (column + 0.5) / 320, (row + 0.5) / 180)
    session.orbit.pivot = tuple(at - session.centre)
    for azimuth, elevation in ((20, 2), (35, 10)):  # it stays in the middle
        session.orbit.azimuth, session.orbit.elevation = azimuth, elevation
        clip = session.camera(16 / 9)[1] @ [*at, 1.0]
        np.testing.assert_allclose(clip[:2] / clip[3], 0, atol=1e-6)
        distance = np.linalg.norm(session.camera(16 / 9)[0] - at)
        assert distance == pytest.approx(session.orbit.distance)
    assert place(session, 0.001, 0.001) is None


def test_false_colours_show_luminance(session):
    radiance = session.radiance(width=160, height=90)
    session.look.mode, session.look.white = "false_color", 0.5
    shown = session.frame(160, 90).pixels.astype(int)
    first, last = ([int(SCALE[i][c:c + 2], 16) for c in (1, 3, 5)] for i in (0, -1))
    luminance, seen = radiance @ LUMINANCE, session.shown.material > 0
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


def test_another_method_on_the_right_and_side_by_side(session):
    alone = session.frame(200, 90).pixels
    session.against = "none"
    other = session.look.copy()
    other.method = "none"
    both = session.frame(200, 90).pixels
    assert np.array_equal(both[:, :98], alone[:, :98]) and (both[:, 102:] != alone[:, 102:]).any()
    session.against, session.other = "", other
    np.testing.assert_array_equal(session.frame(200, 90).pixels, both)
    session.beside = True
    pair = session.frame(200, 90).pixels
    session.other = session.beside = None
    left = session.frame(100, 90).pixels
    session.look = other
    right = session.frame(100, 90).pixels
    np.testing.assert_array_equal(pair[:, :99], left[:, :99])
    np.testing.assert_array_equal(pair[:, 101:], right[:, 1:])


def test_presets_and_what_was_open_come_back(session, tmp_path):
    path = tmp_path / "there" / "view.json"
    memory = Memory(path)
    assert recall(memory, session) == "" and not memory.problem
    session.look.roughness, session.orbit.azimuth, session.orbit.pivot = 0.77, 64.0, (1.0, 2.0, 3.0)
    other = Memory(path)
    memory.update(presets={"Mine": session.look.to_dict(), "Old": {}})
    memory.update(presets={"Old": None})
    other.opened["Skin"] = True
    remember(other, session)  # another viewer's presets stay
    assert [p.name for p in path.parent.iterdir()] == ["view.json"]
    again = Memory(path)
    assert list(again.part("presets")) == ["Mine"] and again.opened == {"Skin": True}
    elsewhere = Memory(path)
    elsewhere.update(last={"mesh": str(tmp_path / "dropped.obj")})
    back = Session(session.device)
    assert recall(elsewhere, back) == "" and back.look == session.look
    back = Session(session.device)
    assert recall(again, back) == str(files.standard_head())
    assert back.look == session.look == Look.from_dict(again.part("presets")["Mine"])
    assert back.orbit == session.orbit and len(back.mesh.positions) == len(session.mesh.positions)
    # Flags come before what is remembered, and are remembered like it, also when the next run has none.
    flagged, later = Session(session.device), Session(session.device)
    assert recall(again, flagged, up="z", subdivide=0, mm=10) == str(files.standard_head())
    remember(again, flagged)
    assert recall(Memory(path), later) == str(files.standard_head()) and later.mm == 10
    assert later.read == {"subdivide": 0, "up": "z"}
    np.testing.assert_array_equal(later.mesh.positions, flagged.mesh.positions)
    assert len(later.mesh.positions) < len(back.mesh.positions)


@pytest.mark.parametrize("text", ["{", "[]", pytest.param("[" * 100000, id="deep"), '{"last": 3}',
                                  '{"last": {"mesh": "HEAD", "look": {"roughnes": 1}}}',
                                  '{"last": {"mesh": "HEAD", "look": {}, "orbit": {}, "mm": "x"}}',
                                  '{"last": {"mesh": "HEAD", "look": [], "orbit": {}, "mm": 1}}',
                                  '{"last": {"mesh": "HEAD", "look": {}, "orbit": [], "mm": 1}}',
                                  '{"last": {"mesh": "HEAD.gone", "look": {}, "orbit": {}, "mm": 1}}',
                                  '{"last": {"mesh": "BAD", "look": {}, "orbit": {}, "mm": 1000}}'])
def test_a_damaged_memory_is_no_obstacle(session, tmp_path, text):
    path = tmp_path / "view.json"
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nf 1 2 3\n")
    path.write_text(text.replace("HEAD", str(files.standard_head())).replace("BAD", str(bad)))
    memory = Memory(path)
    assert bool(memory.problem) == ("last" not in text)
    look = session.look.copy()
    assert recall(memory, session) == "" and session.look == look and session.mm == 1
    memory.update(presets={"Mine": look.to_dict()})
    assert json.loads(path.read_text())["presets"]["Mine"]["roughness"] == look.roughness
