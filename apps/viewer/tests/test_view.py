"""The viewer without its page: OpenGL against geometry, pictures, what is counted."""
import json
import time
import types

import numpy as np
import pytest
from view_session import files, reset

from pellucid import Device
from pellucid.view.camera import Orbit, direction
from pellucid.view.history import PAUSE
from pellucid.view.look import EYES, PRESETS, SKIN, Look
from pellucid.view.pictures import TILE_COLORS, chosen_method, tiles
from pellucid.view.server import SLOW_LIGHT, Pace, Viewer
from pellucid.view.session import Session, iris_image

# Values that the standard look does not have.
SLIDERS = {"radius_scale": 3.0, "albedo": (0.5, 1, 1), "specular": 0.9, "roughness": 0.6, "f0": 0.1,
           "pores": 0.4, "ambient": 0.5, "pupil": 3.5, "iris_color": (0.1, 0.2, 0.5), "iris_seed": 7,
           "iris_concavity": 0.6, "iris_profile": "skin", "limbus_width": 2.0, "limbus_darkening": 0.1,
           "cornea_radius": 9.0, "chamber_depth": 4.0, "tear_roughness": 0.2, "gaze": (20.0, 10.0)}
OTHERS = {"profile": "jade", "method": "none", "ggx": True}


def test_positions_lie_on_the_rays_of_their_pixels(session):
    w, h = 120, 60
    g = session.gbuffer(w, h)
    eye, matrix = session.camera(w / h)
    rows, columns = np.nonzero(g.material)
    assert len(rows) > 0.1 * w * h
    clip = np.c_[g.position[rows, columns], np.ones(len(rows))] @ matrix.T
    assert np.allclose((clip[:, 0] / clip[:, 3] + 1) / 2 * w, columns + 0.5, atol=0.02)
    assert np.allclose((1 - clip[:, 1] / clip[:, 3]) / 2 * h, rows + 0.5, atol=0.02)  # row 0 is the top one
    outward = g.normal_geometric[rows, columns]
    assert np.allclose(np.linalg.norm(outward, axis=1), 1, atol=1e-5)
    assert ((eye - g.position[rows, columns]) * outward).sum(1).min() > -30
    assert {SKIN, EYES} <= set(np.unique(g.material[rows, columns]))
    assert g.position[g.material == 0].max(initial=0) == 0


def test_planes_enclose_a_ball_closely():
    orbit = Orbit(distance=10)
    eye, matrix = orbit.matrices((0, 1, 0), (0, 0, 1), (0, 0, 0), 1.0, 1.0)
    back = eye / np.linalg.norm(eye)
    for at, end in ((back, -1), (-back, 1)):
        clip = matrix @ [*at, 1.0]
        assert 0.9 < end * clip[2] / clip[3] < 1


def test_lights_are_the_lamps_that_are_on_and_their_maps_are_a_third_as_large_while_something_moves(session):
    look = session.look
    look.lamps[0].on, look.lamps[1].shadow, look.lamps[2].shadow = False, False, True
    for lamp in look.lamps[1:]:
        lamp.on, lamp.intensity, lamp.color = True, 0.5, (1.0, 0.8, 0.6)
    for small in (False, True):
        (plain, none), (light, map) = session.lights(look, small)
        assert none is None and map.depth.shape == (look.shadow_size // (1 + 2 * small),) * 2
        assert light.shadow_filter_texels == 48
        for found in plain, light:
            assert found.color == pytest.approx((0.5, 0.4, 0.3))


def test_the_shadow_map_agrees_with_the_positions(session):
    g = session.gbuffer(200, 100)
    seen = g.position[g.material > 0].astype(float)
    lamp = session.look.lamps[0]
    map = session.shadow_map(lamp, 1024)
    assert np.allclose(map.light.to_light, direction((0, 1, 0), (0, 0, 1), lamp.azimuth, lamp.elevation),
                       atol=1e-6)
    m = map.light.world_to_shadow.reshape(4, 4).astype(float)
    q = seen @ m[:3, :3].T + m[:3, 3]
    assert q.min() > 0 and q.max() < 1
    behind = (q[:, 2] - map.depth[(q[:, 1] * 1024).astype(int),
                                  (q[:, 0] * 1024).astype(int)]) * map.light.shadow_depth_range
    # Nothing is in front of the first surface, except by a texel's slope and where a texel misses an edge;
    # most of a lit face is that surface.
    assert np.percentile(behind, 5) > -1.0 and np.percentile(np.abs(behind), 30) < 0.3  # mm


def test_a_sheet_throws_a_shadow_by_either_side(session):
    assert session.renderer._closed  # a head's back sides are left out
    corners = np.array([[x, y, 0] for x in (-50, 50) for y in (-50, 50)], np.float32)
    sheet = Session(session.device)
    sheet.show(files.Mesh(corners, np.tile(np.float32([0, 0, 1]), (4, 1)),
                          np.array([[0, 2, 1], [2, 3, 1]], np.uint32), low=(-50, -50, 0), high=(50, 50, 0)))
    for side in 1, -1:
        assert (sheet.renderer.shadow_map((0, 0, side), 32, level=1)[0] < 1).mean() > 0.3


def test_every_setting_changes_the_picture(session):
    before = session.radiance(None, 160, 90)
    for name, value in {**SLIDERS, **OTHERS}.items():
        reset(session)
        setattr(session.look, name, value)
        assert not np.array_equal(session.radiance(None, 160, 90), before), name
    for name, value in {"azimuth": 0.0, "elevation": 60.0, "color": (1, 0, 0), "intensity": 2.0,
                        "shadow": False, "on": False}.items():
        reset(session)
        setattr(session.look.lamps[0], name, value)
        assert not np.array_equal(session.radiance(None, 160, 90), before), name
    reset(session)
    session.look.profile, session.look.distance = "custom", (2.0, 0.1, 0.1)
    custom = session.radiance(None, 160, 90)
    session.look.distance = (0.1, 0.1, 0.1)
    assert not np.array_equal(session.radiance(None, 160, 90), custom)
    reset(session)
    # no such eye: the iris goes as deep as it must
    session.look.chamber_depth, session.look.cornea_radius = 0.5, 7.0
    assert np.isfinite(session.radiance(None, 160, 90)).all()
    reset(session)
    assert np.array_equal(session.radiance(None, 160, 90), before)  # same input, same bits


def test_no_slider_builds_a_program_once_the_picture_is_at_rest(session):
    session.frame(160, 90)
    session.prepare(160, 90)
    built = session.device.stats().programs_built
    for name, value in {**SLIDERS, "deep_scatter": (1.0, 0.2, 0.1), "transmission": 0.0, "ambient": 0.0,
                        "specular": 0.0, "f0": 0.0, "pores": 0.0, "radius_scale": 5.0,
                        "target_error": 0.004, "profile": "skin-pale"}.items():
        reset(session)
        setattr(session.look, name, value)
        for small in (True, False):
            session.frame(80 if small else 160, 45 if small else 90, small)
        assert session.device.stats().programs_built == built, name
    reset(session)
    session.look.ambient = session.look.transmission = 0.0
    session.look.deep_scatter, session.look.albedo = (1.0, 1.0, 1.0), (0.5, 1.0, 1.0)
    session.frame(160, 90)
    assert session.device.stats().programs_built == built


def test_an_iris_is_a_square_of_a_picture(session, tmp_path):
    session.look.iris_texture = str(tmp_path / "none.png")
    with pytest.raises(files.FileError, match="none.png"):
        session.frame(160, 90)
    wide = np.zeros((8, 16, 3), np.uint8)
    wide[:, 4:12], wide[:, :4] = 128, 255
    files.write_image(tmp_path / "wide.png", wide)
    image = iris_image(tmp_path / "wide.png")
    assert image.shape == (8, 8, 3) and np.allclose(image, 0.2158605, atol=1e-6)  # sRGB's 128
    files.write_image(tmp_path / "light.exr", np.full((4, 4, 3), 0.3, np.float32))
    assert np.allclose(iris_image(tmp_path / "light.exr"), 0.3)
    files.write_image(tmp_path / "grey.exr", np.zeros((4, 4, 1), np.float32))
    with pytest.raises(ValueError, match="R, G and B"):
        iris_image(tmp_path / "grey.exr")
    before = session.look.copy()
    session.look.iris_texture = ""
    plain = session.radiance(None, 160, 90)
    session.look = before
    session.look.iris_texture, session.look.iris_color = str(tmp_path / "wide.png"), (1.0, 1.0, 1.0)
    assert not np.array_equal(session.radiance(None, 160, 90), plain)


def test_moving_pictures_look_like_those_at_rest(session):
    whole, size = Session(session.device), (480, 270)
    whole.load(files.standard_head())
    assert whole._level(True) == 1 and whole._level(False) == 0  # a coarser mesh is in use
    rest = whole.smooth(*size).astype(int)
    whole.prepare(*size)
    assert whole.shown.material.shape == rest.shape[:2]  # what the probe looks at
    off = np.abs(whole.frame(*size, 3).pixels - rest).max(2)
    assert off.shape == (270, 480) and np.median(off) <= 1 and (off > 20).mean() < 0.01
    calls, drawn, maps = [], whole.renderer.gbuffer, whole.renderer.shadow_map
    whole.renderer.gbuffer = lambda *a, **k: calls.append("G-buffer") or drawn(*a, **k)
    whole.renderer.shadow_map = lambda *a, **k: calls.append("map") or maps(*a, **k)
    for _ in range(4):
        whole.orbit.azimuth += 1.5
        turned = whole.frame(*size, 3).pixels.astype(int)
    assert calls == ["G-buffer"]  # for three of them; the first is made from that of the view at rest
    whole._detailed = None
    bare = whole.frame(*size, 3).pixels.astype(int)
    there, ids = whole.smooth(*size).astype(int), whole.shown.material
    off, without = (np.abs(p - there).max(2) for p in (turned, bare))
    assert (off > 20).mean() < 0.01 and ((turned.max(2) > 0) != (ids > 0)).mean() < 0.003
    assert off[ids == EYES].mean() < 0.6 * without[ids == EYES].mean()
    # With other light there are no details, and every picture is shaded; only moved surfaces are drawn again.
    whole.prepare(*size)
    calls.clear()
    for expected in ["map"], ["map", "map"]:
        whole.look.lamps[0].azimuth += 20
        lit = whole.frame(*size, 3).pixels.astype(int)
        assert calls == expected
    assert np.abs(lit - there).mean() > 2 and np.abs(lit - whole.smooth(*size)).mean() < 0.8
    # The third picture of a view is made without the mesh, and is the same, with details and without.
    whole.prepare(*size)
    for mode in "final", "difference":  # the background is black, and is not
        whole.look.mode = mode
        whole.frame(*size, 3), whole.frame(*size, 3)
        reused = whole.frame(*size, 3).pixels.astype(int)
        render, whole.renderer._reuse = whole.renderer._reuse, None
        whole.renderer._view = ()
        off = np.abs(whole.frame(*size, 3).pixels - reused)
        whole.renderer._reuse = render
        assert (off > 1).mean() < 1e-3
    whole.look.mode = "difference"
    assert (whole.frame(*size, 3).pixels[0, 0] == whole.frame(*size).pixels[0, 0]).all()  # not black

    def moved(*a, **k):  # the page turns the camera while a picture is made
        whole.orbit.azimuth += 5
        return drawn(*a, **k)

    whole.renderer._view = ()
    expected = whole.frame(*size, 3).pixels
    whole._shaded, whole.renderer.gbuffer = None, moved
    whole._gbuffers.clear()
    assert np.array_equal(whole.frame(*size, 3).pixels, expected)


def test_edges_become_smooth(session):
    rough = session.frame(160, 90).pixels
    smooth = session.smooth(160, 90)
    background = session.gbuffer(160, 90).material == 0
    # Pixels of the outline are now between head and background; elsewhere hardly anything changes.
    between = background & (smooth.max(2) > 8)
    assert background.any() and not rough[background].any() and 50 < between.sum() < 1500
    inside = np.abs(smooth.astype(int) - rough).max(2)[~background]
    assert np.median(inside) < 6
    assert np.array_equal(session.frame(160, 90).pixels, rough)
    assert np.array_equal(session.smooth(160, 90), smooth)


def test_tiles_are_those_that_the_shader_counts(session):
    for method in ("auto", "screen", "separable"):
        session.look.method = method
        g = session.gbuffer(320, 176)
        shown, p = tiles(session, session.look, 320, 176, False)
        name = chosen_method(p, session.look)
        assert method in ("auto", name)
        # The brightest pixel of each tile tells its state.
        hue = shown.reshape(11, 16, 20, 16, 3).max((1, 3))
        seen = (g.material > 0).reshape(11, 16, 20, 16).any((1, 3))
        assert ((hue.max(2) > 0) == seen).all()
        tapped = (hue.max(2) > 0.45 * max(TILE_COLORS[name])).sum()
        session.count = True
        counted = p.shader.stats()
        session.count = False
        by = dict(zip(("none", "preintegrated", "separable", "screen", "light", "texture"),
                      counted.tiles_by_scattering))
        # At shadows' ends Lambert's edge is a millimetre wide and the other sharp: a few tiles more.
        assert abs(int(by[name]) - int(tapped)) <= 0.15 * tapped + 2, (method, tapped, by)


def test_pixels_are_counted_when_asked(session):
    fresh = Session(session.device)
    fresh.show(session.mesh)
    assert fresh.frame(160, 90).counts["pixels_specular"] == 0
    fresh.count = True
    fresh.orbit.azimuth += 1
    assert fresh.frame(160, 90).counts["pixels_specular"] > 0


def test_another_device_shows_the_same(session):
    session.look.roughness, session.orbit.azimuth = 0.5, 60.0
    before = session.frame(160, 90).pixels
    again = session.restarted(Device())
    assert np.array_equal(again.frame(160, 90).pixels, before)
    assert again.read == session.read == {"subdivide": 1, "up": "auto"}


def test_pictures_are_as_small_as_the_time_asks():
    slow, fast = Pace(), Pace()
    assert slow.step == (1.0, 3)
    for i in range(60):
        slow.shown(0.2 * i, True)
        fast.shown(0.01 * i, True)
    assert slow.step == Pace.STEPS[-1] and fast.step == Pace.STEPS[0] == (1.0, 1)
    steady = Pace()
    for i in range(60):
        steady.shown(0.045 * i, True)
    assert steady.step == (1.0, 3)
    for i in range(60):
        steady.shown(3 + 0.045 * i, True, SLOW_LIGHT)
    assert steady.step == (0.8, 4), "no smaller for a light's sake"
    # Larger pictures that turn out too slow are not tried again at once.
    torn, seen, now = Pace(), [], 0.0
    for _ in range(50):
        now += 0.02 if torn.step[1] >= 3 else 0.09
        torn.shown(now, True)
        seen.append(torn.step)
    assert (1.0, 2) in seen and seen[-1] == (1.0, 3) and sum(a != b for a, b in zip(seen, seen[1:])) == 2


def test_the_mouse_takes_the_object_along():
    """A drag over a part of the picture's height: the point under the mouse follows, from front and side."""
    look = Look()
    shown = types.SimpleNamespace(orbit=Orbit(distance=30), look=look, other=None,
                                  renderer=types.SimpleNamespace(radius=10.0))
    device = types.SimpleNamespace(set_progress=lambda report: None)
    state = Viewer(lambda: device, lambda device: shown).opened()

    def place(point=(0, 0, 0)):
        """(x to the right, y down) in heights of the picture, and the distance."""
        clip = shown.orbit.matrices((0, 0, 1), (0, -1, 0), (0, 0, 0), 10, 2)[1] @ (*point, 1)
        return np.array([clip[0] / clip[3], -0.5 * clip[1] / clip[3]]), clip[3]

    for shown.orbit.azimuth in (0, 70):
        before = place()[0]
        state.apply({"kind": "pan", "dx": 0.2, "dy": -0.1})
        np.testing.assert_allclose(place()[0] - before, (0.2, -0.1), atol=1e-6)
    shown.orbit = Orbit(azimuth=0, elevation=0, distance=30)
    near = (0, -5, 0)  # of the front: it goes with the mouse when the object turns
    state.apply({"kind": "orbit", "dx": 0.1, "dy": 0.0})
    assert place(near)[0][0] > 0.01 and abs(place(near)[0][1]) < 1e-6
    state.apply({"kind": "orbit", "dx": -0.1, "dy": 0.1})
    assert abs(place(near)[0][0]) < 1e-6 and place(near)[0][1] > 0.01
    before = place()[1]
    state.apply({"kind": "zoom", "dy": -0.1})
    assert place()[1] < 0.95 * before
    azimuth, elevation = look.lamps[0].azimuth, look.lamps[0].elevation
    state.apply({"kind": "light", "dx": 0.1, "dy": -0.1})
    turned = look.lamps[0].azimuth - azimuth, look.lamps[0].elevation - elevation
    assert turned == pytest.approx((12, 12))
    # Redo restores the state after the last of many motions.
    state.apply({"kind": "light", "dx": 0.1, "dy": 0.0})
    assert state.undo() and state.redo()
    assert shown.look.lamps[0].azimuth == pytest.approx(azimuth + 24)
    # One after the other, they come back one by one.
    for roughness in (0.21, 0.41):
        time.sleep(PAUSE)
        shown.look.roughness = roughness
        state.changed()
    assert state.undo() and shown.look.roughness == 0.21
    shown.mesh = types.SimpleNamespace(low=(-5, -5, -5), high=(5, 5, 5))
    state.new_object()
    assert not state.undo(), "to a camera that frames the mesh before"


def test_eyes_look_where_those_of_the_mesh_do(session):
    eyes = session.eyes(session.look)
    assert len(eyes) == 2
    for eye, ball in zip(eyes.values(), session.mesh.eyes):
        assert np.allclose(eye.gaze, ball["gaze"] / np.linalg.norm(ball["gaze"]), atol=1e-6)


def test_presets_and_looks():
    for name, values in PRESETS.items():
        look = Look.from_dict(values)
        assert Look.from_dict(json.loads(json.dumps(look.to_dict()))) == look, name
    assert type(Look.from_dict({"exposure": 1}).exposure) is float  # sliders keep a value's type
    for wrong, message in (({"gloss": 1}, "no 'gloss'"), ([], "JSON object"), ({"albedo": [1, 1]}, "albedo"),
                           ({"albedo": 1}, "albedo of a look"), ({"roughness": "x"}, "roughness"),
                           ({"lamps": []}, "lamps"), ({"lamps": [1]}, "a lamp is"),
                           ({"lamps": [{"on": 1}]}, "on of a lamp"), ({"white": float("nan")}, "white"),
                           ({"profile": "skn"}, "profile of a look is 'skn'")):
        with pytest.raises(ValueError, match=message):
            Look.from_dict(wrong)
