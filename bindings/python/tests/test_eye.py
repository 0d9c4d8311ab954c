"""Eyes: the table, and a picture in which they make a difference."""
import numpy as np
import pytest

import pellucid as pel

SIZE, RADIUS = 96, 12.0


def test_table(device):
    lut = pel.Lut.eye(device, width=32, height=16, depth=8)
    texels = lut.read()
    assert texels.shape == (16 * 8, 32, 3) and lut.info.kind == pel.LutKind.EYE and "128" in repr(lut)
    assert np.array_equal(pel.Lut.from_texels(device, lut.info, texels).read(), texels)


def test_eye_with_an_iris_and_a_reflection(device):
    """A ball seen from the front, its eye towards the camera."""
    y, x = np.mgrid[SIZE / 2 - 0.5:-SIZE / 2:-1, -SIZE / 2 + 0.5:SIZE / 2] / SIZE * 2.2 * RADIUS
    inside = x**2 + y**2 < RADIUS**2
    position = np.stack([x, y, np.sqrt(np.where(inside, RADIUS**2 - x**2 - y**2, 1.0))], -1)
    normal = position / np.linalg.norm(position, axis=-1, keepdims=True)
    out = np.zeros((SIZE, SIZE, 3), np.float32)
    shader = pel.Shader(device).set_image("radiance", out).set_image("position", position.astype(np.float32))
    shader.set_image("normal_shading", normal.astype(np.float32)).set_image("material", inside)
    shader.set_material(1, pel.Material(scattering="none")).set_lights([pel.Light(to_light=(0.6, 0, 0.8))])
    shader.set_camera(pel.Camera(position=(0, 0, 400))).set_options(count_pixels=1)
    shader.set_eye(1, pel.Eye()).set_eye(1, None).commit().execute()
    assert shader.stats().pixels_eye == 0
    green, faces = np.full((64, 64, 3), [0, 1, 0], np.float32), np.zeros((6, 8, 8, 3), np.float32)
    shader.set_eye(1, pel.Eye(tear_index=1, limbus_darkening=0)).set_iris_texture(1, green).commit().execute()
    assert 0 < shader.stats().pixels_iris < shader.stats().pixels_eye == shader.stats().pixels_shaded
    iris = out[48 - 15, 40:56]
    assert (iris[:, 1] > 0.05).all() and (iris[:, [0, 2]] == 0).all()
    faces[4, ..., 2] = 10  # +z, behind the camera
    shader.set_lights([]).set_eye(1, pel.Eye(), pel.Lut.eye(device))
    shader.set_reflection_cube(faces).commit().execute()
    assert shader.stats().features & pel.Feature.REFLECTION_CUBE and out[48, 48, 2] > 0 == out[48, 48, 0]
    behind, even = out[48, 48, 2], []
    for side in (2, 16):
        shader.set_reflection_cube(np.full((6, side, side, 3), 10, np.float32)).commit().execute()
        even.append(out.copy())
    assert np.allclose(*even, rtol=1e-5) and np.allclose(even[0][48, 48], behind, rtol=1e-3)
    with pytest.raises(ValueError, match="six faces"):
        shader.set_reflection_cube(faces[:5])
    sky = np.zeros((8, 16, 3), np.float32)
    sky[4:, :, 0] = 10  # red from below, or, with other axes, from the camera
    shader.set_reflection_cube(None).set_environment(sky, [[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    shader.commit().execute()
    assert out[48, 48, 0] > 0.2 and out[48, 48, 2] == 0
    shader.set_environment(None).commit().execute()
    assert not out[48, 48].any()
    with pytest.raises(pel.PellucidError, match="right angles"):
        shader.set_environment(sky, np.ones((3, 3)))
