"""glTF scenes in Python: the same as `pellucid import` makes."""
import base64
import json
import math
import subprocess

import numpy as np
import pytest

import pellucid as pel
from pellucid import _command, _show

files = pytest.importorskip("pellucid.files", reason="this build reads no files")

WAX = {"name": "Candle wax",
       "pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.8, 0.7, 1], "metallicFactor": 0,
                                "roughnessFactor": 0.6, "baseColorTexture": {"index": 0}},
       "extensions": {"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 1},
                      "KHR_materials_volume": {"thicknessFactor": 0.02, "attenuationDistance": 0.0015,
                                               "attenuationColor": [0.4, 0.3, 0.1]},
                      "KHR_materials_volume_scatter": {"multiscatterColor": [0.95, 0.8, 0.5]}}}
PLASTER = {"name": "Plaster", "pbrMetallicRoughness": {"metallicFactor": 0}}
RADIUS = 0.02  # m


# An octahedron with outward faces.
POINTS = np.vstack([np.eye(3), -np.eye(3)]) * RADIUS
FACES = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
PNG = _show.png(np.full((2, 2, 3), 200, np.uint8))


@pytest.fixture
def glb(tmp_path):
    """Two octahedra, of wax and of plaster, a camera and a lamp."""
    parts = [POINTS.astype("<f4").tobytes(), (POINTS[:, :2] + RADIUS).astype("<f4").tobytes(),
             np.array(FACES, "<u4").tobytes(), PNG]
    starts = np.cumsum([0] + [len(p) for p in parts]).tolist()
    document = {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1, 2, 3]}], "materials": [WAX, PLASTER],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2,
                                    "material": m}]} for m in (0, 1)],
        "nodes": [{"mesh": 0}, {"mesh": 1, "translation": [0.05, 0, 0]},
                  {"camera": 0, "translation": [0, 0, 0.12]},
                  {"extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.01, "aspectRatio": 1.5}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": math.pi}]}},
        "buffers": [{"byteLength": starts[-1], "uri": "data:;base64," + base64.b64encode(
            b"".join(parts)).decode()}],
        "bufferViews": [{"buffer": 0, "byteOffset": start, "byteLength": len(p)}
                        for start, p in zip(starts, parts)],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5126, "count": 6, "type": "VEC2"},
                      {"bufferView": 2, "componentType": 5125, "count": 24, "type": "SCALAR"}]}
    path = tmp_path / "balls.gltf"
    path.write_text(json.dumps(document))
    return path


def test_a_scene_as_arrays_and_structures(glb):
    assert min(pel.load_gltf(glb).lights[0].color) > 0  # by an exposure that is chosen
    scene = pel.load_gltf(glb, lights=1)
    assert scene.names == {1: "Candle wax", 2: "Plaster"} and scene.taken_for == {1: "volume", 2: "plain"}
    mesh, (wax, plaster) = scene.mesh, scene.materials.values()
    (light,), (camera,) = scene.lights, scene.cameras
    assert mesh.low == pytest.approx((-20, -20, -20), abs=0.1)  # mm
    assert mesh.high == pytest.approx((70, 20, 20), abs=0.1) and mesh.uvs.shape == (len(mesh.positions), 2)
    assert set(mesh.ids) == {1, 2} and (mesh.positions[mesh.ids == 2, 0] > 29).all()
    assert wax.profile.info.width[0] > 1.5 * wax.profile.info.width[2] > 0 and plaster.profile is None
    small = pel.load_gltf(glb, unit_mm=10).materials[1].profile.info.width
    assert small == pytest.approx(wax.profile.info.width / 100, rel=1e-3)
    assert plaster.f0 == pytest.approx(0.04) and wax.roughness == pytest.approx(0.36)
    assert scene.textures == {1: PNG}
    assert light.color == pytest.approx((1, 1, 1)) and light.to_light == pytest.approx((0, 0, 1))
    assert camera.position == pytest.approx((0, 0, 120)) and camera.forward == pytest.approx((0, 0, -1))
    assert camera.vertical_fov == 0.5
    small = pel.load_gltf(glb, unit_mm=10, lights=0.5, profiles={"Plaster": "marble"})  # centimetres
    assert np.allclose(small.mesh.positions, mesh.positions / 100, atol=1e-6)
    assert small.cameras[0].position[2] == pytest.approx(1.2)
    assert small.lights[0].color[0] == pytest.approx(0.5) and small.taken_for[2] == "profile"
    assert small.materials[2].profile.info.name == "marble"
    assert {m.profile.info.name for m in pel.load_gltf(glb, profiles="jade").materials.values()} == {"jade"}


def test_it_is_saved_as_the_command_does(glb, tmp_path):
    pel.load_gltf(glb, profiles={"Plaster": "marble"}).save(tmp_path / "mine")
    assert {p.name for p in (tmp_path / "mine").iterdir()} == {"scene.toml", "mesh.obj", "mesh.mtl",
                                                               "Candle_wax.toml"}
    again = pel.load_scene(tmp_path / "mine/scene.toml")
    assert again.profiles[2] == "marble" and again.camera.position[2] == pytest.approx(120)
    wax = pel.load_gltf(glb).materials[1].profile
    assert pel.files.load_profile(again.profiles[1]).info.width == pytest.approx(wax.info.width)
    if not _command.program().exists():
        pytest.skip("this build has no command")
    subprocess.run([_command.program(), "import", glb, "-o", tmp_path / "its", "--profile", "Plaster=marble"],
                   check=True, stdout=subprocess.PIPE)
    for name in ("mesh.obj", "mesh.mtl", "Candle_wax.toml"):
        assert (tmp_path / "its" / name).read_bytes() == (tmp_path / "mine" / name).read_bytes(), name


@pytest.mark.parametrize("use, error, message", [
    (lambda glb, f: pel.load_gltf(f / "none.glb"), files.FileError, "none.glb"),
    (lambda glb, f: pel.load_gltf(f / "mesh.obj"), files.FileError, "glb"),
    (lambda glb, f: pel.load_gltf(glb, profiles={"Head": "skin"}), ValueError, "are Candle wax, Plaster"),
    (lambda glb, f: pel.load_gltf(glb, profiles="granite"), files.FileError, "granite"),
    (lambda glb, f: pel.load_gltf(glb, unit_mm=0), ValueError, "unit_mm"),
    (lambda glb, f: pel.load_gltf(glb, lights=math.nan), ValueError, "lights"),
    (lambda glb, f: pel.load_gltf(glb).save(glb / "x"), files.FileError, "balls.gltf/x"),
    (lambda glb, f: files.load_profile(f / "none.toml"), files.FileError, "none.toml")])
def test_errors(glb, tmp_path, use, error, message):
    with pytest.raises(error, match=message):
        use(glb, tmp_path)
