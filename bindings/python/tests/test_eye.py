"""Eyes: the table, and a picture in which they make a difference."""
import numpy as np
import pytest

import pellucid as pel


def ball(n=96, radius=12.0):
    """Positions and normals of a ball seen from the front, its eye towards the camera, and ids."""
    y, x = np.mgrid[n / 2 - 0.5:-n / 2:-1, -n / 2 + 0.5:n / 2] / n * 2.2 * radius
    inside = x**2 + y**2 < radius**2
    z = np.sqrt(np.where(inside, radius**2 - x**2 - y**2, 1.0))
    position = np.stack([x, y, z], -1).astype(np.float32)
    return position, (position / np.linalg.norm(position, axis=-1,
                                                keepdims=True)).astype(np.float32), inside.astype(np.uint8)


def shaded(device, prepare, n=96):
    position, normal, ids = ball(n)
    out = np.zeros((n, n, 3), np.float32)
    shader = pel.Shader(device)
    for slot, image in (("position", position), ("normal_shading", normal), ("material", ids),
                        ("radiance", out)):
        shader.set_image(slot, image)
    shader.set_material(1, pel.Material(scattering="none", albedo=(0.8, 0.8, 0.8)))
    shader.set_camera(pel.Camera(position=(0, 0, 400)))
    shader.set_options(count_pixels=1)
    shader.set_lights([pel.Light(to_light=(0.6, 0, 0.8))])
    prepare(shader)
    shader.commit().execute()
    return out, shader.stats()


def test_table(device):
    lut = pel.Lut.eye(device, width=32, height=16, depth=8)
    texels = lut.read()
    assert texels.shape == (16 * 8, 32, 3) and lut.info.kind == pel.LutKind.EYE
    assert 0.5 < texels[:16].mean() < 1 and texels[-16:].max() < 0.1
    again = pel.Lut.from_texels(device, lut.info, texels)
    assert np.array_equal(again.read(), texels) and "128" in repr(lut)
    with pytest.raises(pel.PellucidError, match="PEL_LUT_HALF"):
        lut.read("faceworks8")


def test_eye_of_one_color(device):
    texture = np.zeros((64, 64, 3), np.float32)
    texture[..., 1] = 1

    def eye(shader):
        shader.set_eye(1, pel.Eye(tear_index=1, limbus_darkening=0)).set_iris_texture(1, texture)

    out, stats = shaded(device, eye)
    plain, before = shaded(device, lambda shader: None)
    assert before.pixels_eye == 0 and stats.pixels_eye == stats.pixels_shaded == before.pixels_shaded
    assert 0 < stats.pixels_caustic <= stats.pixels_iris < stats.pixels_eye / 2
    iris = out[48 - 15, 40:56]
    assert (iris[:, 1] > 0.05).all() and (iris[:, [0, 2]] == 0).all()
    assert (out[46:50, 46:50] == 0).all()  # the pupil
    assert np.array_equal(out[40:56, 4:10], plain[40:56, 4:10])  # the sclera


def test_reflection_cube(device):
    faces = np.zeros((6, 8, 8, 3), np.float32)
    faces[4, ..., 2] = 10  # +z, behind the camera

    def dark(shader):
        shader.set_lights([]).set_eye(1, pel.Eye()).set_reflection_cube(faces)

    out, stats = shaded(device, dark)
    assert stats.features & pel.Feature.REFLECTION_CUBE
    assert out[48, 48, 2] == pytest.approx(10 * (0.336 / 2.336) ** 2, rel=0.05) and out[48, 48, 0] == 0
    with pytest.raises(ValueError, match="six faces"):
        pel.Shader(device).set_reflection_cube(faces[:5])


def test_removed_again(device):
    plain, _ = shaded(device, lambda shader: None)
    out, stats = shaded(device, lambda shader: shader.set_eye(1, pel.Eye()).set_eye(1, None))
    assert np.array_equal(out, plain) and stats.pixels_eye == 0
