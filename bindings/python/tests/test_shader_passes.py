"""Normal maps and ambient cubes, in the shapes that arrays may have."""
import numpy as np
import pytest
from shader_view import HEIGHT, WIDTH, black, shader_for

import pellucid as pel


def test_normal_map(device, view, tolerance):
    texels, out = np.full((16, 8, 3), [0.6, 0, 0.8], np.float32), black()
    tangent = np.cross([0, 1, 0], view.normal)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=-1, keepdims=True), 1e-6)
    shader = shader_for(device, view, out, albedo=np.ones_like(view.albedo), position=view.position,
                        uv=np.zeros((HEIGHT, WIDTH, 2), np.float32), tangent=tangent.astype(np.float32))
    sh = np.zeros((9, 3))  # by which radiance is 1 + Nb / 2
    for channel, basis in enumerate((3, 1, 2)):
        sh[basis, channel] = 0.5 / np.sqrt(3 / (4 * np.pi))
    shader.set_material(1, pel.Material(normal_blend=[1, 1, 1], diffusion_radius=3, uv_scale=100))
    shader.set_lights([]).set_ambient(pel.Ambient(constant=[1, 1, 1], sh=sh))
    tilted, close = 0.6 * tangent + 0.8 * view.normal, tolerance["mappedNormal"]
    in_bytes = np.rint(np.dstack([texels * 127.5 + 127.5, texels[..., :1]])).astype(np.uint8)
    for levels, right, error in ((texels, tilted, close), ([texels, texels[::2, ::2]], tilted, close),
                                 (in_bytes, tilted, 0.01), (None, view.normal, close)):
        shader.set_normal_map(1, levels).commit().execute()
        assert bool(shader.stats().features & pel.Feature.NORMAL_MAP) == (levels is not None)
        assert np.abs(2 * (out - 1) - right)[view.inside].max() < error
    with pytest.raises(ValueError, match="3 components of float64"):
        shader.set_normal_map(1, texels.astype(float))
    with pytest.raises(pel.PellucidError, match="must be 4 x 8"):
        shader.set_normal_map(1, [texels, texels])


def test_ambient_cube(device, view, tolerance):
    # Light that grows along (1, 2, -1): a cube of it against the harmonics of order 1.
    s, t = np.meshgrid((2 * np.arange(32) + 1) / 32 - 1, (2 * np.arange(32) + 1) / 32 - 1)
    one = np.ones_like(s)
    d = np.stack([np.stack(face, -1) for face in [(one, -t, -s), (-one, -t, s), (s, one, t), (s, -one, -t),
                                                  (s, -t, one), (-s, -t, -one)]])
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    cube = np.repeat((0.6 + d @ [0.1, 0.2, -0.1])[..., None], 3, -1).astype(np.float32)
    out = black()
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
