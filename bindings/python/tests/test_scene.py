"""Scene files from Python: what they hold, and pictures to the bits of the command."""
import json
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

import pellucid as pel

files = pytest.importorskip("pellucid.files", reason="this build reads no files")

SCENE = """version = 1
target_error = 0.004
[channels]
position = ["Position.X", "Position.Y", "Position.Z"]
normal_geometric = ["Normal.X", "Normal.Y", "Normal.Z"]
normal_shading = ["Normal.X", "Normal.Y", "Normal.Z"]
curvature = "Curvature.V"
material = "Id.I"
[camera]
position = [0, 0, 300]
[ambient]
constant = [0.05, 0.06, 0.07]
[[light]]
type = "directional"
to_light = [0.8, 0.0, 0.6]
color = [1.0, 0.9, 0.8]
[light.shadow_map]
file = "map.exr"
channel = "Z"
projection = "parallel"
world_to_shadow = [0.01, 0, 0, 0.5, 0, 0.01, 0, 0.5, -0.004, 0, -0.003, 0.5, 0, 0, 0, 1]
depth_range = 200
[[material]]
id = 1
profile = "skin"
specular = 0.4
[[material]]
id = 2
scattering = "none"
albedo = [0.2, 0.3, 0.4]
"""


def ball(width=96, height=80, radius=35.0):
    y, x = np.mgrid[height / 2 - 0.5:-height / 2:-1, -width / 2 + 0.5:width / 2]
    z = np.sqrt(np.maximum(radius**2 - x**2 - y**2, 0))
    inside = z > 0
    n = np.stack([x, y, z], -1) / radius
    channels = {"Position.X": x, "Position.Y": y, "Position.Z": z, "Curvature.V": np.full_like(x, 1 / radius),
                "Id.I": np.where(inside, np.where(y > 20, 2, 1), 0),
                **{f"Normal.{c}": n[..., i] for i, c in enumerate("XYZ")}}
    return {k: np.float32(np.where(inside, v, 0)) for k, v in channels.items()}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    gbuffer = ball()
    files.write_image(tmp_path / "gbuffer.exr", np.stack(list(gbuffer.values()), -1), channels=list(gbuffer))
    files.write_image(tmp_path / "map.exr", np.full((64, 64), 0.3, np.float32), channels=["Z"])
    return tmp_path


def command(folder, scene="scene.toml"):
    program = os.environ.get("PELLUCID_COMMAND")
    if not program:
        pytest.skip("the pellucid command is not built")
    said = subprocess.run([program, "shade", "gbuffer.exr", "--scene", scene, "-o", "again.exr", "--stats",
                           "--json"], cwd=folder, check=True, stdout=subprocess.PIPE).stdout
    image = files.read_image(folder / "again.exr")
    return np.stack([image[c] for c in "RGB"], -1), json.loads(said)["stats"]


def test_what_a_scene_holds(folder):
    scene = pel.load_scene(folder / "scene.toml")
    assert set(scene.materials) == {1, 2} and scene.profiles == {1: "skin", 2: ""}
    assert scene.materials[1].specular == pytest.approx(0.4) and scene.materials[2].scattering.name == "NONE"
    assert len(scene.lights) == 1 and np.allclose(scene.lights[0].to_light, (0.8, 0, 0.6))
    assert np.allclose(scene.ambient.constant, (0.05, 0.06, 0.07))
    assert np.allclose(scene.camera.position, (0, 0, 300))
    assert scene.options.target_error == pytest.approx(0.004)
    assert scene.channels["curvature"] == ["Curvature.V"]
    assert "2 materials, 1 lights" in repr(scene)


def test_the_gbuffer_that_a_scene_names(folder, device):
    scene = folder / "scene.toml"
    (folder / "gbuffer.exr").rename(folder / "own.exr")
    files.write_image(folder / "gbuffer.exr", np.zeros((2, 2, 3), np.float32))  # not the one
    scene.write_text(SCENE.replace("[channels]", 'gbuffer = "own.exr"\n[channels]', 1))
    assert pel.load_scene(scene).gbuffer_file() == folder / "own.exr"
    assert pel.shade(pel.load_scene(scene), device).radiance.shape == (80, 96, 3)


def test_names_have_no_nul(folder):
    scene = pel.load_scene(folder / "scene.toml")
    with pytest.raises(files.FileError, match="NUL"):
        scene.save(folder / "a.toml\0.txt")
    with pytest.raises(files.FileError, match="NUL"):
        pel.load_scene(f"{folder}/scene.toml\0.x")
    with pytest.raises(ValueError, match="NUL"):
        pel.Profile.named("skin\0more")
    assert not (folder / "a.toml").exists()


def test_the_bits_are_those_of_the_command(folder, device):
    made = pel.shade(pel.load_scene(folder / "scene.toml"), device)
    assert made.radiance.shape == (80, 96, 3) and made.radiance.max() > 0.1
    assert np.array_equal(made.radiance, command(folder)[0])
    assert made._repr_png_().startswith(b"\x89PNG") and "96 x 80" in repr(made)
    made.save(folder / "picture.png")
    assert files.read_image(folder / "picture.png")["R"].shape == (80, 96)


def test_changes_count_and_come_back(folder, device):
    scene = pel.load_scene(folder / "scene.toml", ball())
    first = pel.shade(scene, device)
    built = device.stats().programs_built
    scene.materials[1].roughness = 0.5
    scene.lights[0].color = (0.5, 0.9, 0.8)
    second = pel.shade(scene)
    assert not np.array_equal(first.radiance, second.radiance)
    assert device.stats().programs_built == built
    scene.materials[1].profile = "marble"  # whose medium is known, so that its gain is a pass of its own
    second = pel.shade(scene)
    fresh = pel.load_scene(folder / "scene.toml", ball())
    fresh.materials[1].roughness, fresh.profiles[1], fresh.lights[0].color = 0.5, "marble", (0.5, 0.9, 0.8)
    assert np.array_equal(pel.shade(fresh, device).radiance, second.radiance)
    scene.materials[1].roughness = pel.load_scene(folder / "scene.toml").materials[1].roughness
    scene.lights[0].color = (1.0, 0.9, 0.8)
    scene.materials[1].profile = None
    assert np.array_equal(pel.shade(scene).radiance, first.radiance)
    second_material = ball()["Id.I"] == 2
    del scene.materials[2]
    assert not pel.shade(scene).radiance[second_material].any() and first.radiance[second_material].all()
    scene.lights.append(pel.Light(to_light=(-1, 0, 0), color=(1, 1, 1)))
    assert pel.shade(scene).radiance[40, 15].max() > first.radiance[40, 15].max() + 0.05


def test_outputs_and_counters(folder, device):
    scene = pel.load_scene(folder / "scene.toml")
    made = pel.shade(scene, device, outputs=["specular", "diffuse", "thickness"], count=True)
    assert set(made.outputs) == {"specular", "diffuse", "thickness"}
    assert made.outputs["thickness"].shape == (80, 96)
    assert made.stats.pixels_shaded == (ball()["Id.I"] > 0).sum() and not scene.options.count_pixels
    assert np.allclose(made.outputs["diffuse"] + made.outputs["specular"], made.radiance, atol=1e-5)
    ours, theirs = made.stats.to_dict(), command(folder)[1]
    assert set(ours) == set(theirs) - {"passes"}
    for name in (n for n in ours if n.startswith(("pixels_", "tiles_", "scatter_"))):
        said = theirs[name]
        assert ours[name] == (list(said.values()) if isinstance(said, dict) else said), name
    assert list(theirs["pixels_by_choice"]) == [m.name.lower() for m in pel.Scattering]


def test_what_is_saved_shades_the_same(folder, device, monkeypatch):
    scene = pel.load_scene(folder / "scene.toml")
    scene.materials[1].specular, scene.profiles[1] = 0.7, "skin-pale"
    scene.options.target_error = 0.01
    made = pel.shade(scene, device).radiance
    for name in ("deeper", "skin-pale"):  # the latter is a profile of the library none the less
        (folder / name).mkdir()
    monkeypatch.chdir(folder)
    scene.save(folder / "deeper/changed.toml")
    assert 'file = "../map.exr"' in (folder / "deeper/changed.toml").read_text()
    again = pel.load_scene(folder / "deeper/changed.toml", folder / "gbuffer.exr")
    assert np.array_equal(pel.shade(again, device).radiance, made)
    scene.materials[1].profile = pel.Profile.burley_distance(0.5)
    with pytest.raises(ValueError, match="material 1 has a profile object"):
        scene.save(folder / "own.toml")


def test_channels_can_be_changed(folder, device):
    scene = pel.load_scene(folder / "scene.toml", ball())
    first = pel.shade(scene, device).radiance
    del scene.channels["curvature"]
    without = pel.shade(scene).radiance
    scene.channels["curvature"] = "Curvature.V"
    assert np.array_equal(pel.shade(scene).radiance, first)
    del scene.channels["curvature"]
    scene.channels["normal_shading"] = ["Normal.X", "Normal.Z", "Normal.Y"]
    other = pel.shade(scene).radiance
    scene.save(folder / "changed.toml")
    assert np.array_equal(pel.shade(pel.load_scene(folder / "changed.toml", ball()), device).radiance, other)
    assert not np.array_equal(other, without) and first.shape == without.shape
    scene.channels["normals"] = ["Normal.X", "Normal.Y", "Normal.Z"]
    with pytest.raises(ValueError, match="no image 'normals'"):
        pel.shade(scene)


def test_what_a_file_cannot_hold_is_not_saved(folder):
    for change in [{"region_width": 8}, {"region_y": 8}, {"invalid_color": (1, 0, 0)}]:
        scene = pel.load_scene(folder / "scene.toml", ball())
        for field, value in change.items():
            setattr(scene.options, field, value)
        with pytest.raises(ValueError, match="set it after loading"):
            scene.save(folder / "changed.toml")


def test_any_number_is_refused_or_shaded(folder, device):
    """Fields are checked by the library, so nothing before may trust them."""
    gbuffer = {name: pixels[::8, ::8] for name, pixels in ball().items()}
    scene = pel.load_scene(folder / "scene.toml", gbuffer)
    refused = 0
    for struct in [scene.materials[1], scene.lights[0], scene.ambient, scene.camera, scene.options]:
        for field in struct.field_names():
            value = getattr(struct, field)
            if not isinstance(value, int):
                continue
            try:
                setattr(struct, field, 2**31 - 1)
                assert np.isfinite(pel.shade(scene, device).radiance).all()
            except (pel.PellucidError, ValueError):
                refused += 1
            setattr(struct, field, value)
    assert refused > 10


def test_errors(folder, device):
    scene = pel.load_scene(folder / "scene.toml", ball())
    scene.materials[1].roughness = -1.0
    with pytest.raises(pel.PellucidError, match="roughness"):
        pel.shade(scene, device)
    scene.materials[1].roughness = 0.3
    assert pel.shade(scene).radiance.max() > 0.1
    (folder / "gbuffer.exr").unlink()
    channels = {name: pixels for name, pixels in ball().items() if name != "Curvature.V"}
    for call, error, message in [
            (lambda: pel.load_scene(folder / "none.toml"), files.FileError, "none.toml"),
            (lambda: pel.shade(pel.load_scene(folder / "scene.toml")), ValueError, "no G-buffer"),
            (lambda: pel.shade(pel.load_scene(folder / "scene.toml", channels), device), files.FileError,
             "Curvature.V"),
            (lambda: pel.shade(scene, outputs=["gloss"]), ValueError, "no output 'gloss'"),
            (lambda: scene.set_gbuffer({"Position.X": np.zeros((4, 4)), "Position.Y": np.zeros((2, 3))}),
             ValueError, r"Position.Y has the shape \(2, 3\), others have"),
            (lambda: scene.set_gbuffer({}), ValueError, "no pixels"),
            (lambda: scene.set_gbuffer({"Position.X": np.zeros((0, 4))}), ValueError, "no pixels"),
            (lambda: pickle.dumps(scene), TypeError, "load it there")]:
        with pytest.raises(error, match=message):
            call()
    for of, key, value, message in [("materials", -1, pel.Material(), "materials: -1 is not an id"),
                                    ("materials", "a", pel.Material(), "materials: 'a' is not an id"),
                                    ("materials", 1, None, r"materials\[1\] is None"),
                                    ("profiles", 1, None, r"profiles\[1\] is None")]:
        scene = pel.load_scene(folder / "scene.toml", ball())
        getattr(scene, of)[key] = value
        for call in (lambda: pel.shade(scene, device), lambda: scene.save(folder / "no.toml")):
            with pytest.raises(TypeError, match=message) as said:
                call()
            assert "\n" not in str(said.value)


COLD = """import sys, time
import numpy as np
import pellucid as pel
scene = pel.load_scene("scene.toml")
first = pel.shade(scene, wait=False)
end = time.monotonic() + 120
while (made := pel.shade(scene, wait=False)).stats.stands_in and time.monotonic() < end:
    time.sleep(0.2)
np.savez("made.npz", first=first.radiance, last=made.radiance)
assert not scene.options.build_in_background
print(first.stats.stands_in, made.stats.stands_in)
"""


def test_a_picture_stands_in_while_kernels_are_built(folder):
    caches = {"POCL_CACHE_DIR": str(folder / "pocl"), "PELLUCID_CACHE_DIR": str(folder / "cache")}
    for path in caches.values():
        os.mkdir(path)
    # Few kernels, for compilers take most of the time.
    (folder / "scene.toml").write_text(SCENE.split("[light.shadow_map]")[0] + '[[material]]\nid = 1\n'
                                       'profile = "skin"\nscattering = "separable"\n')
    out = subprocess.run([sys.executable, "-c", COLD], cwd=folder, env={**os.environ, **caches}, check=True,
                         capture_output=True, text=True).stdout
    if out.split()[0] == "0":
        pytest.skip("this device builds no programs in the background")
    assert out.split() == ["1", "0"]
    made = np.load(folder / "made.npz")
    whole = pel.shade(pel.load_scene(folder / "scene.toml")).radiance
    assert np.array_equal(made["last"], whole) and not np.array_equal(made["first"], whole)
