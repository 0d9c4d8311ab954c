"""Eyes: the table, and a picture in which they make a difference."""
import numpy as np
import pytest

import pellucid as pel

SIZE, RADIUS = 96, 12.0


def shaded(device, prepare):
    """A ball seen from the front, its eye towards the camera: the picture and what was counted."""
    y, x = np.mgrid[SIZE / 2 - 0.5:-SIZE / 2:-1, -SIZE / 2 + 0.5:SIZE / 2] / SIZE * 2.2 * RADIUS
    inside = x**2 + y**2 < RADIUS**2
    position = np.stack([x, y, np.sqrt(np.where(inside, RADIUS**2 - x**2 - y**2, 1.0))], -1)
    out = np.zeros((SIZE, SIZE, 3), np.float32)
    shader = pel.Shader(device).set_image("radiance", out).set_image("position", position.astype(np.float32))
    normal = position / np.linalg.norm(position, axis=-1, keepdims=True)
    shader.set_image("normal_shading", normal.astype(np.float32)).set_image("material", inside)
    shader.set_material(1, pel.Material(scattering="none", albedo=(0.8, 0.8, 0.8)))
    shader.set_camera(pel.Camera(position=(0, 0, 400))).set_options(count_pixels=1)
    prepare(shader.set_lights([pel.Light(to_light=(0.6, 0, 0.8))]))
    shader.commit().execute()
    return out, shader.stats()


def test_table(device):
    lut = pel.Lut.eye(device, width=32, height=16, depth=8)
    texels = lut.read()
    assert texels.shape == (16 * 8, 32, 3) and lut.info.kind == pel.LutKind.EYE and "128" in repr(lut)
    assert np.array_equal(pel.Lut.from_texels(device, lut.info, texels).read(), texels)
    with pytest.raises(pel.PellucidError, match="PEL_LUT_HALF"):
        lut.read("faceworks8")


def test_eye_with_an_iris_and_a_reflection(device):
    green, faces = np.full((64, 64, 3), [0, 1, 0], np.float32), np.zeros((6, 8, 8, 3), np.float32)
    faces[4, ..., 2] = 10  # +z, behind the camera
    plain, before = shaded(device, lambda shader: shader.set_eye(1, pel.Eye()).set_eye(1, None))
    assert before.pixels_eye == 0
    out, stats = shaded(device, lambda shader: shader.set_eye(
        1, pel.Eye(tear_index=1, limbus_darkening=0)).set_iris_texture(1, green))
    assert stats.pixels_eye == stats.pixels_shaded == before.pixels_shaded
    assert 0 < stats.pixels_caustic <= stats.pixels_iris < stats.pixels_eye / 2
    iris = out[48 - 15, 40:56]
    assert (iris[:, 1] > 0.05).all() and (iris[:, [0, 2]] == 0).all()
    assert np.array_equal(out[40:56, 4:10], plain[40:56, 4:10])  # the sclera
    out, stats = shaded(device, lambda shader: shader.set_lights([]).set_eye(
        1, pel.Eye(), pel.Lut.eye(device)).set_reflection_cube(faces))
    assert stats.features & pel.Feature.REFLECTION_CUBE
    assert out[48, 48, 2] == pytest.approx(10 * (0.336 / 2.336) ** 2, rel=0.05) and out[48, 48, 0] == 0
    with pytest.raises(ValueError, match="six faces"):
        pel.Shader(device).set_reflection_cube(faces[:5])
