"""The viewer without its page: OpenGL against geometry, pictures, what is exported."""
import json
import os
import subprocess

import numpy as np
import pytest

pytest.importorskip("moderngl", reason="moderngl is not installed")
files = pytest.importorskip("pellucid.files", reason="this build reads no files")
from pellucid.view.camera import Orbit, direction  # noqa: E402
from pellucid.view.export import export  # noqa: E402
from pellucid.view.look import EYES, MODES, PRESETS, SKIN, Look  # noqa: E402
from pellucid.view.session import Session  # noqa: E402


@pytest.fixture(scope="module")
def session():
    try:
        made = Session()
    except RuntimeError as error:
        pytest.skip(f"no OpenGL: {error}")
    made.load(files.standard_head(), subdivide=1)
    return made


def reset(session):
    session.look, session.other, session.orbit = Look(), None, Orbit()
    session.orbit.frame(session.mesh.low, session.mesh.high, 2)


def test_positions_lie_on_the_rays_of_their_pixels(session):
    reset(session)
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


def test_the_shadow_map_agrees_with_the_positions(session):
    reset(session)
    g = session.gbuffer(200, 100)
    seen = g.position[g.material > 0].astype(float)
    lamp = session.look.lamps[0]
    map = session.shadow_map(lamp, 1024)
    assert np.allclose(map.light.to_light, direction((0, 1, 0), (0, 0, 1), lamp.azimuth, lamp.elevation), atol=1e-6)
    m = map.light.world_to_shadow.reshape(4, 4).astype(float)
    q = seen @ m[:3, :3].T + m[:3, 3]
    assert q.min() > 0 and q.max() < 1
    behind = (q[:, 2] - map.depth[(q[:, 1] * 1024).astype(int), (q[:, 0] * 1024).astype(int)]) * map.light.shadow_depth_range
    # Nothing stands before the first surface but by a texel's slope, and where a texel looks past an edge; most of a lit face is
    # that surface.
    assert np.percentile(behind, 5) > -1.0 and np.percentile(np.abs(behind), 30) < 0.3  # mm


def test_every_picture_shows_something_of_its_own(session):
    reset(session)
    seen = {}
    for mode in MODES:
        session.look.mode = mode
        frame = session.frame(160, 90)
        assert frame.pixels.shape == (90, 160, 3) and frame.pixels.dtype == np.uint8
        assert frame.counts["pixels_invalid"] == 0
        seen[mode] = frame.pixels.tobytes()
        if mode not in ("deep_scatter", "thickness"):  # nothing where nothing thin is lit from behind
            assert frame.pixels.std() > 0, mode
    pictures = [seen[m] for m in ("final", "lambert", "difference", "error", "specular", "irradiance", "normals", "albedo")]
    assert len(set(pictures)) == len(pictures)


def test_every_setting_changes_the_picture(session):
    reset(session)
    before = session.radiance(None, 160, 90)
    changes = {"profile": "jade", "radius_scale": 3.0, "method": "none", "albedo": (0.5, 1, 1), "specular": 0.9, "roughness": 0.6,
               "f0": 0.1, "ggx": True, "pores": 0.4, "ambient": 0.5, "pupil": 3.5}
    for name, value in changes.items():
        reset(session)
        setattr(session.look, name, value)
        assert not np.array_equal(session.radiance(None, 160, 90), before), name
    for name, value in {"azimuth": 0.0, "elevation": 60.0, "color": (1, 0, 0), "intensity": 2.0, "shadow": False, "on": False}.items():
        reset(session)
        setattr(session.look.lamps[0], name, value)
        assert not np.array_equal(session.radiance(None, 160, 90), before), name
    reset(session)
    session.look.profile, session.look.distance = "custom", (2.0, 0.1, 0.1)
    custom = session.radiance(None, 160, 90)
    session.look.distance = (0.1, 0.1, 0.1)
    assert not np.array_equal(session.radiance(None, 160, 90), custom)
    reset(session)
    assert np.array_equal(session.radiance(None, 160, 90), before)  # same input, same bits


def test_a_change_of_material_builds_no_program(session):
    reset(session)
    session.frame(160, 90)
    built = session.device.stats().programs_built
    session.look.radius_scale, session.look.roughness, session.look.target_error = 1.7, 0.41, 0.004
    session.look.profile = "skin-pale"
    session.frame(160, 90)
    assert session.device.stats().programs_built == built


def test_the_wipe_shows_both_settings(session):
    reset(session)
    left = session.frame(160, 90).pixels
    session.other = Look(method="none", specular=0.0, transmission=0.0, ambient=0.5)
    session.wipe = 0.5
    both = session.frame(160, 90).pixels
    assert np.array_equal(both[:, :78], left[:, :78])
    assert not np.array_equal(both[:, 82:], left[:, 82:])


@pytest.mark.parametrize("profile", ["skin", "custom"])
def test_what_is_exported_renders_to_the_same_bits(session, tmp_path, profile):
    command = os.environ.get("PELLUCID_COMMAND")
    if not command:
        pytest.skip("the pellucid command is not built")
    reset(session)
    session.look.profile, session.look.albedo, session.look.radius_scale = profile, (0.9, 1.0, 1.05), 1.5
    written = {p.name for p in export(session, tmp_path / "look", 192, 108)}
    assert {"scene.toml", "gbuffer.exr", "picture.exr", "picture.png", "look.json", "look.cpp", "shadow_0.exr"} <= written
    subprocess.run([command, "shade", "gbuffer.exr", "--scene", "scene.toml", "-o", "again.exr"], cwd=tmp_path / "look", check=True,
                   stdout=subprocess.DEVNULL)
    one, two = (files.read_image(tmp_path / "look" / name) for name in ("picture.exr", "again.exr"))
    assert all(np.array_equal(one[c], two[c]) for c in "RGB") and one["R"].max() > 0.2
    assert Look.from_dict(json.loads((tmp_path / "look/look.json").read_text())) == session.look


def test_presets_and_looks():
    for name, values in PRESETS.items():
        look = Look.from_dict(values)
        assert Look.from_dict(json.loads(json.dumps(look.to_dict()))) == look, name
    with pytest.raises(ValueError, match="no 'gloss'"):
        Look.from_dict({"gloss": 1})


def test_a_bad_mesh_leaves_the_one_before(session, tmp_path):
    reset(session)
    before, mesh = session.frame(160, 90).pixels, session.mesh
    (tmp_path / "bad.obj").write_text("v 0 0 0\nf 1 2 3\n")
    with pytest.raises(files.FileError, match="bad.obj"):
        session.load(tmp_path / "bad.obj")
    assert session.mesh is mesh and np.array_equal(session.frame(160, 90).pixels, before)
