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
    """A ball seen from the front, its eye towards the camera. What eyes look like: tests/eye."""
    y, x = np.mgrid[SIZE / 2 - 0.5:-SIZE / 2:-1, -SIZE / 2 + 0.5:SIZE / 2] / SIZE * 2.2 * RADIUS
    inside = x**2 + y**2 < RADIUS**2
    position = np.stack([x, y, np.sqrt(np.where(inside, RADIUS**2 - x**2 - y**2, 1.0))], -1)
    normal = position / np.linalg.norm(position, axis=-1, keepdims=True)
    out = np.zeros((SIZE, SIZE, 3), np.float32)
    shader = pel.Shader(device).set_image("radiance", out).set_image("position", position.astype(np.float32))
    shader.set_image("normal_shading", normal.astype(np.float32)).set_image("material", inside)
    shader.set_material(1, pel.Material(scattering="none")).set_lights([pel.Light(to_light=(0.6, 0, 0.8))])
    shader.set_camera(pel.Camera(position=(0, 0, 400))).set_options(count_pixels=1)
    green, faces = np.full((64, 64, 3), [0, 1, 0], np.float32), np.zeros((6, 8, 8, 3), np.float32)
    sky, pictures = np.ones((8, 16, 3), np.float32), []
    faces[4, ..., 2] = 10  # +z, behind the camera
    for change in (lambda: shader.set_eye(1, pel.Eye()), lambda: shader.set_eye(1, None),
                   lambda: shader.set_eye(1, pel.Eye(), pel.Lut.eye(device)),
                   lambda: shader.set_iris_texture(1, green), lambda: shader.set_reflection_cube(faces),
                   lambda: shader.set_reflection_cube(None).set_environment(sky, np.eye(3)),
                   lambda: shader.set_environment(None)):
        change().commit().execute()
        stats = shader.stats()
        assert (0 < stats.pixels_iris < stats.pixels_eye) == (len(pictures) != 1)
        pictures.append(out.tobytes())
    # The table that is given is the one that would be made; what is taken away is as before.
    assert len(set(pictures)) == 5 and pictures[0] == pictures[2] and pictures[3] == pictures[6]
    with pytest.raises(ValueError, match="six faces"):
        shader.set_reflection_cube(faces[:5])
