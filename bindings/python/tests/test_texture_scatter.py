"""Scattering in the texture of a mesh."""
import numpy as np
import pytest

import pellucid as pel


def plate(columns=9):
    """A square of 20 x 20, all of the texture."""
    v, u = np.mgrid[0:columns, 0:columns].astype(np.float32) / (columns - 1)
    uvs = np.stack([u, v], -1).reshape(-1, 2)
    positions = np.concatenate([20 * uvs, np.zeros((len(uvs), 1), np.float32)], 1).astype(np.float32)
    a = (np.arange(columns - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    return positions, uvs, np.concatenate([np.stack([a, a + 1, a + columns + 1], 1),
                                           np.stack([a, a + columns + 1, a + columns], 1)])


def test_draws_scatters_and_is_sampled(device):
    positions, uvs, triangles = plate()
    texture = pel.TextureScatter(device, 64, 48, triangles, uvs)
    with pytest.raises(pel.PellucidError, match="pelTextureScatterSetPositions comes first"):
        texture.execute(np.ones((48, 64, 3), np.float32))
    texture.set_positions(positions)
    place = texture.draw(positions)
    assert np.allclose(place[..., 0], 20 * (np.arange(64) + 0.5) / 64, atol=1e-4)
    normals = texture.draw(np.tile(np.float32([0, 0, 3]), (len(uvs), 1)), unit=True)
    assert np.allclose(normals, [0, 0, 1], atol=1e-6)
    edge = np.repeat((place[..., :1] > 10).astype(np.float32), 3, -1)
    soft = texture.execute(edge)
    assert np.allclose(soft[:, :2], 0, atol=2e-3) and np.allclose(soft[:, -2:], 1, atol=2e-3)
    assert (soft[24, 28] > 0.01).all() or soft[24, 28, 0] > soft[24, 28, 2]  # red reaches furthest
    stats = texture.stats()
    assert stats.texels_covered == stats.texels_total == 64 * 48 and stats.gaussians == 6
    few = texture.execute(edge, params=pel.TextureScatterParams(profile="marble", gaussians=4))
    assert few.shape == edge.shape and texture.stats().gaussians == 4 and texture.stats().profile_error < 0.1
    colors = np.full_like(edge, 0.5)
    assert np.allclose(texture.execute(edge, colors, params=pel.TextureScatterParams(albedo_after=1)),
                       0.5 * soft, atol=1e-6)
    texture.execute(edge, out=edge)
    assert np.array_equal(edge, soft)
    # A shader samples it.
    shader, radiance = pel.Shader(device), np.zeros((8, 8, 3), np.float32)
    uv = np.stack(np.meshgrid(np.linspace(0.1, 0.9, 8), np.full(8, 0.5)), -1).astype(np.float32)
    shader.set_image("radiance", radiance).set_image("uv", uv)
    shader.set_image("normal_shading", np.tile(np.float32([0, 0, 1]), (8, 8, 1)))
    shader.set_material(1, pel.Material(scattering="texture", albedo=[1, 1, 1]))
    shader.set_scattered_texture(1, soft).commit().execute()
    assert radiance[0, 0, 0] < 0.1 < 0.9 < radiance[0, 7, 0]
    shader.set_scattered_texture(1, None)
    with pytest.raises(pel.PellucidError, match="pelShaderSetScatteredTexture"):
        shader.commit()


@pytest.mark.parametrize("change, error, message", [
    (lambda p, u, t: (t.ravel(), u), ValueError, "indices"), (lambda p, u, t: (t, p), ValueError, "uvs"),
    (lambda p, u, t: (t, u - 1), pel.PellucidError, "vertex 0"),
    (lambda p, u, t: (t, u[:4]), pel.PellucidError, "of 4")])
def test_wrong_meshes(device, change, error, message):
    with pytest.raises(error, match=message):
        pel.TextureScatter(device, 8, 8, *change(*plate(3)))
