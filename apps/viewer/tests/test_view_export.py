"""What the viewer exports, scene files in the viewer, and scattering in the texture of a mesh."""
import json

import numpy as np
import pytest
from view_session import files, renders_again, reset

from pellucid.view.export import export
from pellucid.view.look import SKIN, Lamp, Look
from pellucid.view.passes import Pass
from pellucid.view.scene_session import SceneSession
from pellucid.view.session import Session


@pytest.mark.parametrize("profile", ["skin", "custom"])
def test_what_is_exported_renders_to_the_same_bits(session, tmp_path, profile):
    session.look.profile, session.look.albedo, session.look.radius_scale = profile, (0.9, 1.0, 1.05), 1.5
    session.look.gaze, session.look.iris_seed, session.look.limbus_width = (12.0, -5.0), 3, 1.5
    if profile == "custom":
        across = np.linspace(0, 255, 64, dtype=np.uint8)
        files.write_image(tmp_path / "iris.png",
                          np.stack(np.broadcast_arrays(across[:, None], across, np.uint8(40)), 2))
        session.look.iris_texture, session.look.iris_color = str(tmp_path / "iris.png"), (1.0, 1.0, 1.0)
        session.look.iris_profile = "skin"
    written = {p.name for p in export(session, tmp_path / "look", 192, 108)}
    assert {"scene.toml", "gbuffer.exr", "picture.exr", "picture.png", "look.json", "shadow_0.exr"} <= written
    assert renders_again(tmp_path / "look")
    known = session.look.copy()
    if profile == "custom":
        assert "iris.exr" in written
        known.iris_texture = "iris.exr"
    assert Look.from_dict(json.loads((tmp_path / "look/look.json").read_text())) == known


def test_changes_meanwhile_do_not_show_in_what_is_written(session, monkeypatch, tmp_path):
    known, real = session.smooth(96, 54), Pass.shade

    def shade(self, *rest):
        made = real(self, *rest)
        session.orbit.azimuth += 5
        session.look.pores, session.look.mode = 0.5, "normals"
        return made

    monkeypatch.setattr(Pass, "shade", shade)
    export(session, tmp_path, 96, 54)
    assert renders_again(tmp_path) and session.look.mode == "normals"
    reset(session)
    np.testing.assert_array_equal(session.still().smooth(96, 54), known)


def test_a_scene_file_is_shown_as_it_was_exported(session, tmp_path):
    session.look.exposure, session.look.shoulder = 1.3, 0.7
    folder = tmp_path / "look"
    export(session, folder, 192, 108)
    shown = SceneSession(folder / "scene.toml", device=session.device)
    shown.look.exposure, shown.look.shoulder = 1.3, 0.7
    picture = files.read_image(folder / "picture.png")
    known = np.rint(255 * np.stack([picture[c] for c in "RGB"], -1)).astype(np.uint8)
    whole = shown.frame().pixels
    assert np.array_equal(whole, known)
    assert shown.frame(small=True).pixels.shape == (54, 96, 3)
    seen = {"final": whole.tobytes()}
    for mode in ("lambert", "difference", "diffuse", "specular"):
        shown.look.mode = mode
        seen[mode] = shown.frame().pixels.tobytes()
    assert len(set(seen.values())) == len(seen)
    shown.look.mode = "final"
    assert shown.frame().pixels.tobytes() == seen["final"]  # nothing sticks
    shown.scene.profiles.update({1: "marble"})  # whose medium is known, so that its gain is a pass of its own
    assert shown.frame().pixels.tobytes() != seen["final"]
    built = shown.device.stats().programs_built
    for change in (lambda: setattr(shown.scene.materials[1], "roughness", 0.7),
                   lambda: shown.look.lights.__setitem__(0, 0.5),
                   lambda: setattr(shown.look, "ambient", 2.0)):
        before = shown.frame().pixels
        change()
        assert not np.array_equal(shown.frame().pixels, before)
    assert shown.device.stats().programs_built == built
    shown.look.ambient, shown.report = 1.5, print
    assert shown.restarted(shown.device).report is print
    shown.save(folder / "changed.toml")
    shown.report = None
    now = shown.frame().pixels
    again = SceneSession(folder / "changed.toml", folder / "gbuffer.exr", session.device)
    again.look.exposure, again.look.shoulder = 1.3, 0.7
    assert np.array_equal(again.frame().pixels, now)
    (folder / "gbuffer.exr").unlink()
    with pytest.raises(ValueError, match="no G-buffer beside it"):
        SceneSession(folder / "scene.toml", device=session.device)


def test_scattering_in_the_texture(session, tmp_path):
    # Where scattering shows, at edges of shadows, the texture's is that of the other methods.
    session.look.lamps, session.look.ambient, session.look.pores = [Lamp("Key", 75.0, 15.0)], 0.02, 0.0
    session.orbit.azimuth = 25
    by = {}
    for method in ("none", "separable", "texture"):
        session.look.method = method
        by[method] = session.radiance(None, 640, 360)
    skin = session.gbuffer(640, 360).material == SKIN
    changes = [(by[method] - by["none"])[skin, 0] for method in ("texture", "separable")]
    assert np.abs(changes[1]).max() > 0.1 and np.corrcoef(changes)[0, 1] > 0.6
    export(session, tmp_path / "look", 160, 90)
    session.look.lamps[0].intensity = 0.2  # made again
    assert session.radiance(None, 640, 360)[skin].mean() < 0.8 * by["texture"][skin].mean()
    session.look.method = "auto"
    # Texture coordinates of another size are let go.
    assert session.radiance(None, 320, 180).shape == (180, 320, 3)
    bare = Session(session.device)
    (tmp_path / "bare.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    bare.load(tmp_path / "bare.obj")
    bare.look.method = "texture"
    with pytest.raises(ValueError, match="no texture coordinates"):
        bare.frame(160, 90)
    assert renders_again(tmp_path / "look")
