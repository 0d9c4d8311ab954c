"""Meshes and images from files."""
import numpy as np
import pytest

from pellucid._command import program

files = pytest.importorskip("pellucid.files", reason="this build reads no files")


def test_a_head_comes_with_the_package():
    mesh = files.load_mesh(files.standard_head(), subdivide=1)
    n = len(mesh.positions)
    assert mesh.triangles.max() == n - 1
    assert mesh.ids.shape == (n,) and set(np.unique(mesh.ids)) == {1, 2, 3, 4, 5, 6}
    assert mesh.albedo.shape == (n, 3) and 0 < mesh.albedo.min() and mesh.albedo.max() < 1.1
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-4)
    assert mesh.up == (0, 1, 0) and mesh.front == (0, 0, 1)
    assert len(mesh.eyes) == 2 and mesh.eyes[0]["radius"] == pytest.approx(14, abs=3)  # mm
    finer = files.load_mesh(files.standard_head("male"))
    assert len(finer.triangles) > 3 * len(mesh.triangles)


def test_a_mesh_of_ones_own(tmp_path):
    path = tmp_path / "tetrahedron.off"
    path.write_text("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
    mesh = files.load_mesh(path)
    assert mesh.positions.shape == (4, 3) and mesh.triangles.shape == (4, 3)
    assert mesh.up == (0, 0, 1) and files.load_mesh(path, up="y").up == (0, 1, 0)
    assert mesh.low == (0, 0, 0) and mesh.high == (1, 1, 1)
    assert len(files.load_mesh(path, subdivide=2).triangles) == 4 * 16
    with pytest.raises(ValueError, match="'auto', 'y' or 'z'"):
        files.load_mesh(path, up="x")
    with pytest.raises(files.FileError, match="missing.off"):
        files.load_mesh(tmp_path / "missing.off")
    path.write_text("OFF\n4 4 0\n0 0 0\n1 0\n")
    with pytest.raises(files.FileError, match="tetrahedron.off"):
        files.load_mesh(path)


def test_images_come_back(tmp_path):
    rng = np.random.default_rng(3)
    image = rng.uniform(0, 4, (5, 7, 3)).astype(np.float32)
    files.write_image(tmp_path / "a.exr", image)
    back = files.read_image(tmp_path / "a.exr")
    assert all(np.array_equal(back[c], image[..., i]) for i, c in enumerate("RGB"))
    files.write_image(tmp_path / "z.exr", image[..., 0], channels=["Z"])
    assert np.array_equal(files.read_image(tmp_path / "z.exr")["Z"], image[..., 0])
    files.write_image(tmp_path / "h.exr", image, half=True)
    assert np.array_equal(files.read_image(tmp_path / "h.exr")["R"],
                          image[..., 0].astype(np.float16).astype(np.float32))
    files.write_image(tmp_path / "a.png", image, exposure=0.25)
    bytes_ = files.tonemap(image, 0.25)
    assert bytes_.dtype == np.uint8 and bytes_.shape == image.shape
    assert np.array_equal(np.rint(files.read_image(tmp_path / "a.png")["G"] * 255), bytes_[..., 1])
    files.write_image(tmp_path / "b.png", bytes_)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_tone_mapping_is_srgb_below_the_shoulder():
    x = np.array([0, 0.0031308, 0.18, 0.5, 0.8, np.nan, -1, 1e30], np.float32)
    y = files.tonemap(np.stack([x, x, x], 1))[:, 0]
    srgb = np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)
    assert np.array_equal(y[:5], np.rint(255 * srgb[:5]))
    assert y[5] == 0 and y[6] == 0 and y[7] == 255
    grey = np.full((4, 3), 0.18, np.float32)
    assert files.tonemap(grey, curve="agx-like").tolist() == [[128] * 3] * 4
    with pytest.raises(ValueError, match="soft, none, filmic or agx-like"):
        files.tonemap(grey, curve="sepia")


def test_wrong_use_says_what_would_be_right(tmp_path):
    with pytest.raises(ValueError, match=r"\(height, width, channels\)"):
        files.write_image(tmp_path / "a.exr", np.zeros(3))
    with pytest.raises(ValueError, match="5 channels need as many names"):
        files.write_image(tmp_path / "a.exr", np.zeros((2, 2, 5)))
    with pytest.raises(files.FileError, match="a.xyz"):
        files.write_image(tmp_path / "a.xyz", np.zeros((2, 2, 3)))
    with pytest.raises(files.FileError, match="nowhere"):
        files.write_image(tmp_path / "nowhere" / "a.png", np.zeros((2, 2, 3)))
    with pytest.raises(files.FileError):
        files.read_image(tmp_path / "missing.exr")


def test_seams_of_texture_coordinates_are_kept(tmp_path):
    path = tmp_path / "strip.obj"  # two squares that share an edge, whose coordinates differ there
    path.write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
                    "vt 0 0\nvt .4 0\nvt .4 .4\nvt 0 .4\nvt .6 0\nvt 1 0\nvt 1 .4\nvt .6 .4\n"
                    "f 1/1 2/2 5/3 4/4\nf 2/5 3/6 6/7 5/8\n")
    mesh = files.load_mesh(path)
    assert len(mesh.positions) == 8 and mesh.uvs.shape == (8, 2)
    seam = np.abs(mesh.positions[:, 0] - 1) < 1e-6
    assert sorted(mesh.uvs[seam, 0].round(3).tolist()) == pytest.approx([0.4, 0.4, 0.6, 0.6])
    assert np.allclose(mesh.normals, [0, 0, 1])
    assert files.load_mesh(path, subdivide=1).uvs is None


def test_reference_by_a_random_walk(tmp_path):
    if not program().exists():
        pytest.skip("this build has no program")
    side = 50  # of a cube whose top is seen, in mean free paths about
    corners = [(x, y, z) for z in (-side, 0) for y in (-side, side) for x in (-side, side)]
    quads = [(4, 5, 7, 6), (0, 2, 3, 1), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
    triangles = [(a, b, c) for a, b, c, _ in quads] + [(a, c, d) for a, _, c, d in quads]
    (tmp_path / "cube.off").write_text(f"OFF\n8 {len(triangles)} 0\n" + "\n".join(" ".join(map(str, c)) for c in corners) + "\n"
                                       + "\n".join("3 " + " ".join(map(str, t)) for t in triangles) + "\n")
    (tmp_path / "burley.toml").write_text('name = "b"\nsource = "test"\nunit = "mm"\nkind = "burley"\ndistance = [1, 0.5, 0.25]\n')
    (tmp_path / "scene.toml").write_text('version = 2\n[channels]\nposition = ["X", "Y", "Z"]\nnormal_shading = ["X", "Y", "Z"]\n[ambient]\nconstant = [1, 1, 1]\n'
                                         '[[material]]\nid = 1\nprofile = "burley.toml"\n')
    files.write_image(tmp_path / "g.exr", np.zeros((4, 5, 3), np.float32), channels=["X", "Y", "Z"])
    inputs = tmp_path / "cube.off", tmp_path / "scene.toml", tmp_path / "g.exr"
    layers = files.reference(*inputs, walk=True, samples=64, reflectance=[0.8, 0.5, 0.3])
    assert layers["First.R"].shape == (4, 5)
    for channel in "RGB":
        assert np.allclose(layers[f"Surface.{channel}"].mean(), 1, atol=0.05)
    assert layers["Thickness"][0, 0] == pytest.approx(side, rel=1e-3)
    with pytest.raises(files.FileError, match="no known medium"):
        files.reference(*inputs, walk=True, profile="skin")
