"""Matrices of each convention: a shadow map and a depth buffer drawn by the book are read back to the places
they came from."""
import numpy as np
import pytest

import pellucid as pel
from pellucid.conventions import camera_from_view_projection, clip_to_image, light_from_view_projection

DEPTHS = ["-1..1", "0..1", "1..0"]


def look_at(eye, target):
    f = np.subtract(target, eye) / np.linalg.norm(np.subtract(target, eye))
    r = np.cross(f, (0, 1, 0))
    r /= np.linalg.norm(r)
    m = np.eye(4)
    m[:3, :3] = r, np.cross(r, f), -f
    m[:3, 3] = -m[:3, :3] @ eye
    return m


def projection(depth, y_up, perspective, infinite=False, near=2.0, far=9.0):
    """By the definitions of the interfaces: z of clip / w is z0 at the near plane and z1 at the far one."""
    z0, z1 = {"-1..1": (-1, 1), "0..1": (0, 1), "1..0": (1, 0)}[depth]
    m = np.zeros((4, 4))
    m[0, 0], m[1, 1] = 1.3, 1.7 if y_up else -1.7
    if not perspective:
        m[2, 2], m[3, 3] = -(z1 - z0) / (far - near), 1
        m[2, 3] = z0 - (z1 - z0) * near / (far - near)
        return m
    m[3, 2] = -1
    # z * w = a * depth + b
    a = z1 if infinite else (z1 * far - z0 * near) / (far - near)
    b = (z0 - a) * near
    m[2, 2], m[2, 3] = -a, b
    return m


EYE, TARGET = np.array([1.0, 2.0, 5.0]), np.array([0.2, -0.3, 0.1])
rng = np.random.default_rng(5)
POINTS = TARGET + rng.uniform(-0.8, 0.8, (50, 3))


@pytest.mark.parametrize("depth", DEPTHS)
@pytest.mark.parametrize("y_up", [True, False])
@pytest.mark.parametrize("first_row", ["top", "bottom"])
@pytest.mark.parametrize("perspective", [False, True])
def test_a_light_measures_the_distances_of_its_map(depth, y_up, first_row, perspective):
    view = look_at(EYE, TARGET)
    matrix = projection(depth, y_up, perspective) @ view
    light = light_from_view_projection(matrix, depth, y_up, first_row, color=(1, 2, 3))
    assert np.allclose(light.color, (1, 2, 3))
    forward = (TARGET - EYE) / np.linalg.norm(TARGET - EYE)
    along = (POINTS - EYE) @ forward
    m = light.world_to_shadow.reshape(4, 4).astype(float)
    q = np.c_[POINTS, np.ones(len(POINTS))] @ m.T
    u, v, z = (q[:, k] / q[:, 3] for k in range(3))
    # The map's texels by the book: which column and row the point falls on, and what the depth buffer holds
    # there.
    clip = np.c_[POINTS, np.ones(len(POINTS))] @ matrix.T
    x, y, c = (clip[:, k] / clip[:, 3] for k in range(3))
    from_top = 0.5 - 0.5 * y if y_up else 0.5 + 0.5 * y
    assert np.allclose(u, 0.5 + 0.5 * x, atol=1e-5)
    assert np.allclose(v, from_top if first_row == "top" else 1 - from_top, atol=1e-5)
    stored = 0.5 + 0.5 * c if depth == "-1..1" else c
    assert np.allclose(z, stored, atol=1e-5)
    if perspective:
        assert light.type == pel.LightType.SPOT
        assert np.allclose(light.position, EYE, atol=1e-4)
        assert np.allclose(light.spot_direction, forward, atol=1e-5)
        assert np.allclose(1 / (light.shadow_depth_a * stored + light.shadow_depth_b), along, rtol=2e-4)
    else:
        assert light.type == pel.LightType.DIRECTIONAL
        assert np.allclose(light.to_light, -forward, atol=1e-5)
        distances = light.shadow_depth_range * stored
        assert np.allclose(distances - distances[0], along - along[0], atol=1e-4)


@pytest.mark.parametrize("depth", DEPTHS)
@pytest.mark.parametrize("y_up", [True, False])
@pytest.mark.parametrize("infinite", [False, True])
def test_a_camera_finds_places_from_depth(depth, y_up, infinite):
    matrix = projection(depth, y_up, True, infinite) @ look_at(EYE, TARGET)
    camera = camera_from_view_projection(matrix, depth, y_up)
    assert np.allclose(camera.position, EYE, atol=1e-4)
    clip = np.c_[POINTS, np.ones(len(POINTS))] @ matrix.T
    x, y, c = (clip[:, k] / clip[:, 3] for k in range(3))
    stored = 0.5 + 0.5 * c if depth == "-1..1" else c
    # Pellucid: x and y in [-1, 1], y up, z as in the depth image.
    pixel = np.stack([x, y if y_up else -y, stored, np.ones(len(x))], 1)
    world = pixel @ camera.inverse_view_projection.reshape(4, 4).astype(float).T
    assert np.allclose(world[:, :3] / world[:, 3:], POINTS, atol=3e-4)


@pytest.mark.parametrize("use, message", [
    (lambda: clip_to_image("0..2"), "depth is '0..2'"),
    (lambda: light_from_view_projection(np.eye(4), first_row="left"), "'top' or 'bottom'"),
    (lambda: camera_from_view_projection(np.eye(3)), "4 x 4"),
    (lambda: camera_from_view_projection(np.zeros((4, 4))), "no inverse"),
    (lambda: light_from_view_projection(np.diag([1.0, 1, 0, 1])), "makes no depth"),
    (lambda: light_from_view_projection(np.full((4, 4), np.nan)), "finite")])
def test_errors(use, message):
    with pytest.raises(ValueError, match=message):
        use()
