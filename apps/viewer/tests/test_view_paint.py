"""Pictures on meshes in the viewer, and meshes of glTF files."""
import base64
import json

import numpy as np
import pytest
from view_session import files

from pellucid.view import paint
from pellucid.view.look import CUT, SKIN, Look
from pellucid.view.session import Session

# As one sees it: red and green above, blue and white below.
COLORS = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)
CORNERS = np.array([[-50, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]], float)
PLASTER = {"name": "Plaster", "pbrMetallicRoughness": {"metallicFactor": 0}}
UVS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)


@pytest.fixture(scope="module")
def painted(shared_session):
    """A session of this module's own."""
    return Session(shared_session.device)


def save(path, pixels):
    files.write_image(path, np.repeat(np.repeat(pixels, 32, 0), 32, 1))
    return path


def square(folder, uvs=True):
    lines = [f"v {x} {y} {z}" for x, y, z in CORNERS] + [f"vt {u} {v}" for u, v in UVS if uvs]
    path = folder / "square.obj"
    path.write_text("\n".join([*lines, "f 1/1 2/2 3/3 4/4" if uvs else "f 1 2 3 4"]) + "\n")
    return path


def test_large_pictures_become_smaller(tmp_path, monkeypatch):
    file = save(tmp_path / "four.png", COLORS)  # 64 x 64
    assert np.array_equal(paint.read(file)[::32, ::32], COLORS)
    monkeypatch.setattr(paint, "LARGEST", 16)
    for source in (file, file.read_bytes()):
        small = paint.read(source)
        assert small.shape == (16, 16, 3) and np.abs(small[2::11, 2::11].astype(int) - COLORS).max() < 8


def textured_glb(path, materials, texture):
    """A square of each material, side by side; row 0 of the texture is at v = 0."""
    uvs = UVS * [1, -1] + [0, 1]
    parts = [(CORNERS * 1e-3).astype("<f4").tobytes(), uvs.astype("<f4").tobytes(),
             np.array([0, 1, 2, 0, 2, 3], "<u4").tobytes(), texture.read_bytes()]
    starts = np.cumsum([0, *(len(p) for p in parts)]).tolist()
    data = "data:;base64," + base64.b64encode(b"".join(parts)).decode()
    path.write_text(json.dumps({
        "asset": {"version": "2.0"}, "materials": materials,
        "scenes": [{"nodes": list(range(len(materials)))}],
        "images": [{"bufferView": 3, "mimeType": "image/png"}], "textures": [{"source": 0}],
        "nodes": [{"mesh": i, "translation": [0.12 * i, 0, 0]} for i in range(len(materials))],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2,
                                    "material": i}]} for i in range(len(materials))],
        "buffers": [{"byteLength": starts[-1], "uri": data}],
        "bufferViews": [{"buffer": 0, "byteOffset": start, "byteLength": len(p)}
                        for start, p in zip(starts, parts)],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
                      {"bufferView": 2, "componentType": 5125, "count": 6, "type": "SCALAR"}]}))
    return path


def seen(session):
    """The G-buffer from the front, without pores."""
    session.look = Look(pores=0.0)
    session.orbit.azimuth = session.orbit.elevation = 0.0
    session.orbit.frame(session.mesh.low, session.mesh.high, 1)
    session.frame(128, 128)
    return session.shown


def quarters(g):
    """Albedo in the middle of the four quarters of what is seen, as one sees them."""
    rows, columns = np.nonzero(g.material)
    r, c = (np.quantile(v, [0.25, 0.75]).astype(int) for v in (rows, columns))
    return g.albedo[np.ix_(r, c)]


def test_an_albedo_picture_lies_as_its_painter_saw_it(painted, tmp_path):
    painted.load(square(tmp_path))
    bare = seen(painted).albedo.copy()
    painted.paint_skin("albedo", save(tmp_path / "colors.png", COLORS))
    np.testing.assert_allclose(quarters(seen(painted)), COLORS / 255, atol=0.01)
    painted.paint_skin("albedo", save(tmp_path / "grey.png", np.full((2, 2, 3), 188, np.uint8)))
    np.testing.assert_allclose(quarters(seen(painted)), 0.5029, atol=0.01)  # sRGB 188, the newest picture
    painted.show_bare()
    np.testing.assert_array_equal(seen(painted).albedo, bare)


@pytest.mark.parametrize("tilt, towards", [((191, 128, 239), (1, 0)), ((128, 191, 239), (0, 1))])
def test_a_normal_map_turns_normals_to_its_right_and_up(painted, tmp_path, tilt, towards):
    picture = save(tmp_path / "tilt.png", np.full((2, 2, 3), tilt, np.uint8))
    scene = textured_glb(tmp_path / "square.gltf", [PLASTER], save(tmp_path / "colors.png", COLORS))
    for mesh in (square(tmp_path), scene):
        painted.load(mesh)
        painted.paint_skin("normal", picture)
        g = seen(painted)
        normal = g.normal_shading[64, 64]
        assert normal[:2] @ towards == pytest.approx(0.5, abs=0.02)
        assert normal[2] == pytest.approx(0.866, abs=0.02)
        assert abs(normal[:2] @ towards[::-1]) < 0.02 and g.normal_geometric[64, 64, 2] > 0.999
    flat = save(tmp_path / "flat.png", np.full((2, 2, 3), (128, 128, 255), np.uint8))
    painted.paint_skin("normal", flat)
    assert seen(painted).normal_shading[64, 64, 2] > 0.999


def test_a_gltf_file_comes_with_its_pictures(painted, tmp_path):
    wax = {"name": "Wax", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "metallicFactor": 0,
                                                   "baseColorTexture": {"index": 0}},
           "extensions": {"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 1},
                          "KHR_materials_volume": {"thicknessFactor": 0.02, "attenuationDistance": 0.0015,
                                                   "attenuationColor": [0.4, 0.3, 0.1]},
                          "KHR_materials_volume_scatter": {"multiscatterColor": [0.9, 0.8, 0.5]}}}
    colors = save(tmp_path / "colors.png", COLORS)
    painted.load(textured_glb(tmp_path / "two.gltf", [wax, PLASTER], colors))
    assert set(np.unique(painted.mesh.ids)) == {SKIN, CUT} and "Wax" in painted.told
    g = seen(painted)
    plain = g.albedo[g.position[..., 0] > 70]  # the other square
    g.material[g.material != SKIN] = 0
    own = painted.mesh.albedo[painted.mesh.ids == SKIN][0]
    assert own.min() > 0.1
    np.testing.assert_allclose(quarters(g), COLORS / 255 * own, atol=0.01)
    assert len(plain) and np.ptp(plain, 0).max() < 0.01
    painted.load(textured_glb(tmp_path / "one.gltf", [PLASTER], colors))
    assert set(np.unique(painted.mesh.ids)) == {SKIN} and "no material" in painted.told


def test_what_cannot_be_drawn_is_refused_and_the_picture_stays(painted, tmp_path):
    colors = save(tmp_path / "colors.png", COLORS)
    painted.load(square(tmp_path, uvs=False))
    with pytest.raises(ValueError, match="texture coordinates"):
        painted.paint_skin("albedo", colors)
    painted.load(square(tmp_path))
    painted.paint_skin("albedo", colors)
    before = seen(painted).albedo.copy()
    broken = tmp_path / "broken.png"
    broken.write_bytes(colors.read_bytes()[:60])
    for path in (broken, tmp_path / "none.png"):
        with pytest.raises((ValueError, OSError)):
            painted.paint_skin("albedo", path)
    np.testing.assert_array_equal(seen(painted).albedo, before)
