"""Matrices of each convention reach the functions of pellucid_conventions.h, which tests/core checks."""
import numpy as np
import pytest

import pellucid as pel
from pellucid.conventions import camera_from_view_projection, light_from_view_projection

# OpenGL's, from (0, 0, 5) along -z: a perspective with planes at 2 and 9, and a parallel projection.
SPOT = np.array([[1.3, 0, 0, 0], [0, 1.7, 0, 0], [0, 0, -11 / 7, 5 * 11 / 7 - 36 / 7], [0, 0, -1, 5]])
SUN = np.array([[1.3, 0, 0, 0], [0, 1.7, 0, 0], [0, 0, -2 / 7, 10 / 7 - 11 / 7], [0, 0, 0, 1]])


def conventions(gl):
    """The same projection for each convention, and what becomes of it: a factor of y, and of z less 1/2."""
    zero_to_one = gl.copy()
    zero_to_one[2] = (gl[2] + gl[3]) / 2
    backwards = zero_to_one.copy()
    backwards[2] = gl[3] - zero_to_one[2]
    yield gl, {}, 1
    yield gl * [[1], [-1], [1], [1]], {"y_up": False}, 1
    yield zero_to_one, {"depth": "0..1"}, 1
    yield backwards, {"depth": "1..0"}, -1


@pytest.mark.parametrize("gl", [SPOT, SUN])
@pytest.mark.parametrize("first_row", ["top", "bottom"])
def test_a_light_of_each_convention(gl, first_row):
    for matrix, how, z in conventions(gl):
        light = light_from_view_projection(matrix, first_row=first_row, color=(1, 2, 3), **how)
        point = light.world_to_shadow.reshape(4, 4) @ [0.3, 0.2, 0, 1]
        x, y, depth, w = gl @ [0.3, 0.2, 0, 1]
        v = 0.5 - 0.5 * y / w if first_row == "top" else 0.5 + 0.5 * y / w
        assert np.allclose(point[:3] / point[3], [0.5 + 0.5 * x / w, v, 0.5 + 0.5 * z * depth / w], atol=1e-6)
        assert np.allclose(light.color, (1, 2, 3))
        if gl is SUN:
            assert light.type == pel.LightType.DIRECTIONAL and np.allclose(light.to_light, (0, 0, 1))
            assert light.shadow_depth_range == pytest.approx(7 * z)
            continue
        assert light.type == pel.LightType.SPOT
        assert np.allclose([light.position, light.spot_direction], [(0, 0, 5), (0, 0, -1)], atol=1e-5)
        distances = 1 / (light.shadow_depth_a * np.array([0, 1]) + light.shadow_depth_b)
        assert np.allclose(distances[::z], (2, 9), rtol=1e-4)


def test_a_camera_of_each_convention():
    for matrix, how, z in conventions(SPOT):
        camera = camera_from_view_projection(matrix, **how)
        x, y, depth, w = SPOT @ [0.3, 0.2, 0, 1]
        seen = camera.inverse_view_projection.reshape(4, 4) @ [x / w, y / w, 0.5 + 0.5 * z * depth / w, 1]
        assert np.allclose(seen[:3] / seen[3], (0.3, 0.2, 0), atol=1e-4)
        assert np.allclose(camera.position, (0, 0, 5), atol=1e-5)


@pytest.mark.parametrize("use, message", [
    (lambda: light_from_view_projection(SUN, "0..2"), "depth is '0..2'"),
    (lambda: light_from_view_projection(np.eye(4), first_row="left"), "'top' or 'bottom'"),
    (lambda: camera_from_view_projection(np.eye(3)), "4 x 4"),
    (lambda: camera_from_view_projection(np.zeros((4, 4))), "no inverse"),
    (lambda: light_from_view_projection(np.diag([1.0, 1, 0, 1])), "makes no depth"),
    (lambda: light_from_view_projection(np.full((4, 4), np.nan)), "finite")])
def test_errors(use, message):
    with pytest.raises(ValueError, match=message):
        use()
