"""Matrices of each convention reach the functions of pellucid_conventions.h, which tests/core checks."""
import numpy as np
import pytest

import pellucid as pel
from pellucid.conventions import camera_from_view_projection, light_from_view_projection

# OpenGL's, from (0, 0, 5) along -z: a perspective with planes at 2 and 9, and a parallel projection.
SPOT = np.array([[1.3, 0, 0, 0], [0, 1.7, 0, 0], [0, 0, -11 / 7, 5 * 11 / 7 - 36 / 7], [0, 0, -1, 5]])
SUN = np.array([[1.3, 0, 0, 0], [0, 1.7, 0, 0], [0, 0, -2 / 7, 10 / 7 - 11 / 7], [0, 0, 0, 1]])


@pytest.mark.parametrize("gl", [SPOT, SUN])
def test_each_argument_reaches_the_function(gl):
    """The same projection in other conventions is the same light and camera."""
    halved = gl.copy()
    halved[2] = (gl[2] + gl[3]) / 2
    backwards = halved.copy()
    backwards[2] = gl[3] - halved[2]
    light = light_from_view_projection(gl, color=(1, 2, 3))
    assert light.type == (pel.LightType.SPOT if gl is SPOT else pel.LightType.DIRECTIONAL)
    assert np.allclose(light.color, (1, 2, 3))
    place = [0.3, 0.2, 0, 1]
    clip = gl @ place / (gl @ place)[3]
    x, y, z, w = light.world_to_shadow.reshape(4, 4) @ place
    assert np.allclose([x / w, y / w, z / w], 0.5 + 0.5 * clip[:3] * [1, -1, 1], atol=1e-5)
    for matrix, how, depth in ((gl, {}, z), (gl * [[1], [-1], [1], [1]], {"y_up": False}, z),
                               (halved, {"depth": "0..1"}, z), (backwards, {"depth": "1..0"}, w - z)):
        other = light_from_view_projection(matrix, **how).world_to_shadow.reshape(4, 4)
        assert np.allclose(other @ place, [x, y, depth, w], atol=1e-5)
        camera = camera_from_view_projection(matrix, **how)
        seen = camera.inverse_view_projection.reshape(4, 4) @ [clip[0], clip[1], depth / w, 1]
        assert np.allclose(seen / seen[3], place, atol=1e-4)
    below = light_from_view_projection(gl, first_row="bottom").world_to_shadow.reshape(4, 4)
    assert np.allclose(below @ place, [x, w - y, z, w], atol=1e-5)


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
