"""Light from all round in the viewer."""
import numpy as np
import pytest
from view_session import files, renders_again

from pellucid.view import surroundings
from pellucid.view.export import export


@pytest.fixture
def alone(session):
    """The studio and no lamps."""
    for lamp in session.look.lamps:
        lamp.on = False
    session.look.ambient, session.look.surroundings = 0.0, surroundings.STUDIO
    return session


def test_irradiance_is_the_mean_over_the_hemisphere():
    normals = surroundings.directions(4).reshape(-1, 3)
    rows = surroundings.axes((0, 0, 1), (0, -1, 0), 30)
    np.testing.assert_allclose(rows @ rows.T, np.eye(3), atol=1e-6)
    np.testing.assert_allclose(rows[1], (0, 0, 1), atol=1e-6)
    even = surroundings.irradiance(np.ones((32, 64, 3), np.float32), rows, normals)
    np.testing.assert_allclose(even, 1, atol=0.01)
    # 1 + d.y of the image: 1 + 2/3 of the cosine with its y axis, the world's z.
    for height in (32, 31, 20):
        slope = np.repeat((1 + surroundings.directions(height)[..., 1:2]), 3, 2).astype(np.float32)
        seen = surroundings.irradiance(slope, rows, normals)[:, 0]
        np.testing.assert_allclose(seen, 1 + 2 / 3 * normals[:, 2], atol=0.04)


def test_the_shader_and_the_reference_see_the_same_light(alone):
    alone.look.method, alone.look.transmission, alone.look.specular = "none", 0.0, 0.0
    alone.look.pores = 0.0
    radiance = alone.radiance(width=160, height=90)
    g = alone.gbuffer(160, 90)
    skin = g.material == 1
    light = surroundings.irradiance(*alone.surroundings(alone.look), g.normal_shading[skin])
    expected = light * g.albedo[skin]
    assert radiance[skin].mean() > 0.05
    np.testing.assert_allclose(radiance[skin], expected, atol=0.02)


def test_it_turns_shines_and_is_exported(alone, tmp_path):
    front = alone.radiance(width=160, height=90)
    alone.look.surroundings_turn = 120.0
    turned = alone.radiance(width=160, height=90)
    assert np.abs(front - turned).mean() > 0.01
    alone.look.specular = 0.0
    assert (turned - alone.radiance(width=160, height=90)).mean() > 0.001
    alone.look.specular = 0.35
    export(alone, tmp_path, 160, 90)
    # What was dropped on the page lies elsewhere than what is exported.
    alone.look.surroundings = str(tmp_path / "surroundings.exr")
    alone.look.surroundings_light = 1.0
    export(alone, tmp_path / "again", 160, 90)
    assert renders_again(tmp_path / "again")
    assert "surroundings.exr" in (tmp_path / "again" / "look.json").read_text().split('"')
    np.testing.assert_array_equal(files.read_image(tmp_path / "picture.exr")["R"], turned[..., 0])
    assert renders_again(tmp_path)
    alone.look.surroundings = ""
    assert not alone.radiance(width=160, height=90)[alone.gbuffer(160, 90).material == 1].max() > 1e-3


def test_images_that_are_no_surroundings_are_named(alone, tmp_path):
    files.write_image(tmp_path / "square.exr", np.ones((8, 8, 3), np.float32))
    files.write_image(tmp_path / "grey.exr", np.ones((8, 16), np.float32), channels=["Y"])
    for name, words in (("square.exr", "8 x 8; surroundings are twice as wide"), ("grey.exr", "R, G and B"),
                        ("none.exr", "none.exr")):
        with pytest.raises((ValueError, files.FileError), match=words):
            surroundings.read(tmp_path / name)
