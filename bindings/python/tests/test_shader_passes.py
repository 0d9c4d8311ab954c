"""Normal maps and ambient cubes, in the shapes that arrays may have."""
import numpy as np
import pytest
from shader_view import HEIGHT, WIDTH, shader_for

import pellucid as pel


def show_blurred_normal(device, view, **options):
    """A shader whose radiance is 1 + Nb / 2."""
    out = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, out, albedo=np.ones_like(view.albedo), position=view.position)
    sh = np.zeros((9, 3))
    for channel, basis in enumerate((3, 1, 2)):
        sh[basis, channel] = 0.5 / np.sqrt(3 / (4 * np.pi))
    shader.set_material(1,
                        pel.Material(normal_blend=[1, 1, 1], diffusion_radius=3, uv_scale=100)).set_lights([])
    shader.set_ambient(pel.Ambient(constant=[1, 1, 1], sh=sh)).set_options(**options)
    return shader, out


def test_normal_map(device, view, tolerance):
    texels = np.zeros((16, 8, 3), np.float32)
    texels[...] = [0.6, 0, 0.8]
    shader, out = show_blurred_normal(device, view)
    tangent = np.cross([0, 1, 0], view.normal)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=-1, keepdims=True), 1e-6)
    shader.set_image("uv", np.zeros(
        (HEIGHT, WIDTH, 2), np.float32)).set_image("tangent", tangent.astype(np.float32))
    for levels in (texels, [texels, texels[::2, ::2]],
                   np.rint(np.dstack([texels * 127.5 + 127.5, texels[..., :1]])).astype(np.uint8)):
        shader.set_normal_map(1, levels).commit().execute()
        assert shader.stats().features & pel.Feature.NORMAL_MAP
        right = 0.6 * tangent + 0.8 * view.normal
        bytes_ = isinstance(levels, np.ndarray) and levels.dtype == np.uint8
        close = 0.01 if bytes_ else tolerance["mappedNormal"]
        assert np.abs(2 * (out - 1) - right)[view.inside].max() < close
    shader.set_normal_map(1, None).commit().execute()
    assert np.abs(2 * (out - 1) - view.normal)[view.inside].max() < tolerance["mappedNormal"]
    with pytest.raises(ValueError, match="3 components of float64"):
        shader.set_normal_map(1, texels.astype(float))
    with pytest.raises(pel.PellucidError, match="must be 4 x 8"):
        shader.set_normal_map(1, [texels, texels])


def cube_directions(n):
    """The directions of the texels of a cube map's six faces, (6, n, n, 3)."""
    s, t = np.meshgrid((2 * np.arange(n) + 1) / n - 1, (2 * np.arange(n) + 1) / n - 1)
    one = np.ones_like(s)
    return np.stack([np.stack(f, -1)
                     for f in [(one, -t, -s), (-one, -t, s), (s, one, t), (s, -one, -t), (s, -t, one),
                               (-s, -t, -one)]])


def test_ambient_cube(device, view, tolerance):
    # Light that grows along (1, 2, -1): a cube of it against the harmonics of order 1.
    d = cube_directions(32)
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    cube = np.repeat((0.6 + d @ [0.1, 0.2, -0.1])[..., None], 3, -1).astype(np.float32)
    out = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    shader = shader_for(device, view, out).set_lights([]).set_ambient_cube(cube).commit()
    shader.execute()
    assert shader.stats().features == pel.Feature.AMBIENT | pel.Feature.AMBIENT_CUBE
    expected = view.albedo * (0.6 + view.normal @ np.float32([0.1, 0.2, -0.1]))[..., None]
    assert np.abs(out - expected)[view.inside].max() < tolerance["cubeOfHarmonics"]
    once = out.copy()
    cube *= 2  # in place: seen by the next execution
    shader.execute()
    assert np.abs(out - 2 * once).max() < 1e-6
    shader.set_ambient_cube(np.concatenate(list(cube), 1)).commit().execute()  # side by side
    assert np.abs(out - 2 * once).max() < 1e-6
    shader.set_ambient_cube(None).commit().execute()
    assert not out.any()
    for wrong, message in [(np.zeros((5, 4, 4, 3), np.float32), "six faces"),
                           (np.zeros((4, 4, 3), np.float32), "4 x 4"),
                           (np.zeros((6, 5, 4, 3), np.float32)[:, :4], "ascontiguousarray"),
                           (np.zeros((12, 2), np.float32), "three components")]:
        with pytest.raises((ValueError, pel.PellucidError), match=message):
            shader.set_ambient_cube(wrong)
