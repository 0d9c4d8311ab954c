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


@pytest.mark.skipif(not hasattr(files._files, "head_strands"), reason="this build has no Embree")
def test_a_head_has_strands():
    points, counts = files._files.head_strands(str(files.standard_head()), 1)
    assert len(counts) > 10000 and points.shape == (counts.sum(), 4) and (points[:, 3] > 0).all()
    ends = np.cumsum(counts)
    size = np.linalg.norm(points[ends - 1, :3] - points[ends - counts, :3], axis=1)  # mm
    assert 1 < np.percentile(size, 1) and size.max() < 25


def test_a_mesh_of_ones_own(tmp_path):
    path = tmp_path / "tetrahedron.off"
    path.write_text("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
    mesh = files.load_mesh(path)
    assert mesh.positions.shape == (4, 3) and mesh.triangles.shape == (4, 3)
    assert mesh.up == (0, 0, 1) and files.load_mesh(path, up="y").up == (0, 1, 0)
    assert mesh.low == (0, 0, 0) and mesh.high == (1, 1, 1)
    assert len(files.load_mesh(path, subdivide=2).triangles) == 4 * 16


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
    grey = np.full((4, 3), 0.18, np.float32)
    assert files.tonemap(grey, curve="agx-like").tolist() == [[128] * 3] * 4 != files.tonemap(grey).tolist()
    assert np.array_equal(np.rint(files.read_image(tmp_path / "a.png")["G"] * 255), bytes_[..., 1])
    files.write_image(tmp_path / "b.png", bytes_)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize("use, error, message", [
    (lambda f: files.write_image(f / "a.exr", np.zeros(3)), ValueError, r"\(height, width, channels\)"),
    (lambda f: files.write_image(f / "a.exr", np.zeros((2, 2, 5))), ValueError, "5 channels need as many"),
    (lambda f: files.write_image(f / "a.xyz", np.zeros((2, 2, 3))), files.FileError, "a.xyz"),
    (lambda f: files.write_image(f / "no" / "a.png", np.zeros((2, 2, 3))), files.FileError, "a.png"),
    (lambda f: files.read_image(f / "missing.exr"), files.FileError, "missing.exr"),
    (lambda f: files.tonemap(np.zeros((4, 3)), curve="sepia"), ValueError, "soft, none, filmic or agx-like"),
    (lambda f: files.tonemap(np.zeros((4, 4)), curve="agx-like"), ValueError, r"shape \(..., 3\)"),
    (lambda f: files.load_mesh(f / "a.off", up="x"), ValueError, "'auto', 'y' or 'z'"),
    (lambda f: files.load_mesh(f / "a.off", subdivide=7), ValueError, "from 0 to 6"),
    (lambda f: files.load_mesh(f / "a.off", subdivide=-1), ValueError, "from 0 to 6"),
    (lambda f: files.load_mesh(f / "missing.off"), files.FileError, "missing.off"),
    (lambda f: files.load_mesh(f / "bad.off"), files.FileError, "bad.off")])
def test_wrong_use_says_what_would_be_right(tmp_path, use, error, message):
    (tmp_path / "bad.off").write_text("OFF\n4 4 0\n0 0 0\n1 0\n")
    with pytest.raises(error, match=message):
        use(tmp_path)


def test_seams_of_texture_coordinates_are_kept(tmp_path):
    path = tmp_path / "strip.obj"  # two squares that share an edge, whose coordinates differ there
    path.write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
                    "vt 0 0\nvt .4 0\nvt .4 .4\nvt 0 .4\nvt .6 0\nvt 1 0\nvt 1 .4\nvt .6 .4\n"
                    "f 1/1 2/2 5/3 4/4\nf 2/5 3/6 6/7 5/8\n")
    mesh = files.load_mesh(path)
    assert mesh.uvs.shape == (8, 2) and np.allclose(mesh.normals, [0, 0, 1])
    assert files.load_mesh(path, subdivide=1).uvs is None


def test_reference_by_a_random_walk(tmp_path):
    """The command's layers and messages; its numbers: tests/cli/test_cli_reference.cpp."""
    if not program().exists():
        pytest.skip("this build has no program")
    (tmp_path / "cone.off").write_text("OFF\n4 4 0\n-9 -9 -9\n9 -9 -9\n0 9 -9\n0 0 9\n"
                                       "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
    (tmp_path / "burley.toml").write_text('name = "b"\nsource = "test"\nunit = "mm"\nkind = "burley"\n'
                                          'distance = [1, 0.5, 0.25]\n')
    (tmp_path / "scene.toml").write_text(
        'version = 2\n[channels]\nposition = ["X", "Y", "Z"]\nnormal_shading = ["X", "Y", "Z"]\n'
        '[ambient]\nconstant = [1, 1, 1]\n[[material]]\nid = 1\nprofile = "burley.toml"\n')
    files.write_image(tmp_path / "g.exr", np.full((4, 5, 3), [0, 0, 9], np.float32), channels=["X", "Y", "Z"])
    inputs = tmp_path / "cone.off", tmp_path / "scene.toml", tmp_path / "g.exr"
    walk = dict(walk=True, samples=4, reflectance=[0.8, 0.5, 0.3])
    layers = files.reference(*inputs, **walk)
    assert layers["First.R"].shape == (4, 5) and {"Surface.G", "Thickness"} <= set(layers)
    assert not np.array_equal(layers["First.R"], files.reference(*inputs, **walk, seed=2)["First.R"])
    with pytest.raises(files.FileError, match="no known medium"):
        files.reference(*inputs, walk=True, profile="skin")
