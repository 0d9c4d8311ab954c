"""Scattering alone: on the screen, in the texture of a mesh, and by the surface integral."""
import numpy as np
import pytest

import pellucid as pel


def lit(view):
    return view.lambert.copy(), view.position, view.material


def test_execute_submit_and_in_place(device, view):
    irradiance, positions, ids = lit(view)
    scatter = pel.Scatter(device)
    assert np.array_equal(scatter.execute(irradiance, positions, ids=ids), irradiance)
    scatter.set_material(1, pel.Profile.skin())
    result = scatter.execute(irradiance, positions, ids=ids)
    assert np.array_equal(result[ids == 0], irradiance[ids == 0]) and not np.array_equal(result, irradiance)
    assert 0 < scatter.stats().pixels_tapped <= scatter.stats().pixels_covered == ids.sum()
    later = np.empty_like(irradiance)
    scatter.submit_execute(irradiance, positions, later, ids=ids).wait()
    assert np.array_equal(later, result)
    scatter.execute(irradiance, positions, ids=ids, out=irradiance)
    assert np.array_equal(irradiance, result)


def test_warm_up_builds_what_execute_needs(view):
    irradiance, positions, ids = lit(view)
    own = pel.Device()  # whose programs no other test has built
    scatter = pel.Scatter(own)
    scatter.set_material(1, pel.Profile.skin())
    built = own.stats().programs_built
    assert scatter.warm_up(irradiance, positions, ids=ids) == own.stats().programs_built - built > 0
    built = own.stats().programs_built
    scatter.execute(irradiance, positions, ids=ids)
    assert own.stats().programs_built == built


def test_materials_controls_and_images(device, view):
    irradiance, positions, ids = lit(view)
    scatter = pel.Scatter(device)
    scatter.set_material(1, pel.Profile.skin())
    scatter.set_controls(1, scattering="separable", scatter_taps=25)
    tapped = scatter.execute(irradiance, positions, ids=ids)
    stats = scatter.stats()
    assert stats.tiles_by_scattering[int(pel.Scattering.SEPARABLE)] == stats.tiles_tapped > 0
    # Half of the scattered light, and times the albedo.
    scatter.set_image("scatter_weight", np.full(ids.shape, 0.5, np.float32))
    scatter.set_image("albedo", np.full((*ids.shape, 3), 0.25, np.float32))
    half = scatter.execute(irradiance, positions, ids=ids)
    assert np.allclose(half, 0.25 * 0.5 * (irradiance + tapped), atol=1e-6)
    out = np.ones_like(irradiance)
    scatter.execute(irradiance, positions, ids=ids, out=out, params=pel.ScatterParams(accumulate=1))
    assert np.allclose(out, 1 + half, atol=1e-6)
    scatter.set_material(1, None)
    with pytest.raises(pel.PellucidError, match="is not set"):
        scatter.set_controls(1, scatter_taps=8)


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
    texture.set_positions(positions)
    place = texture.draw(positions)
    assert np.allclose(place[..., 0], 20 * (np.arange(64) + 0.5) / 64, atol=1e-4)
    assert np.allclose(texture.draw(np.tile(np.float32([0, 0, 3]), (len(uvs), 1)), unit=True), [0, 0, 1])
    edge = np.repeat((place[..., :1] > 10).astype(np.float32), 3, -1)
    soft = texture.execute(edge)
    assert texture.stats().texels_covered == 64 * 48
    texture.execute(edge, params=pel.TextureScatterParams(profile="marble", gaussians=4))
    assert texture.stats().gaussians == 4
    halved = texture.execute(edge, np.full_like(edge, 0.5), params=pel.TextureScatterParams(albedo_after=1))
    assert np.allclose(halved, 0.5 * soft, atol=1e-6)
    texture.execute(edge, out=edge)
    assert np.array_equal(edge, soft)


@pytest.mark.parametrize("change, error, message", [
    (lambda p, u, t: (t - 1, u), ValueError, "indices"), (lambda p, u, t: (t, p), ValueError, "uvs"),
    (lambda p, u, t: (t, u - 1), pel.PellucidError, "vertex 0"),
    (lambda p, u, t: (t, u[:4]), pel.PellucidError, "of 4")])
def test_wrong_meshes(device, change, error, message):
    with pytest.raises(error, match=message):
        pel.TextureScatter(device, 8, 8, *change(*plate(3)))


def test_surface_integral_of_an_evenly_lit_sheet(device):
    # Far from its border a plane gives back what it gets, whatever the profile.
    positions, _, triangles = plate(41)
    positions = 3 * positions - np.float32([30, 30, 0])
    light, points = np.float32([1, 0.5, 0.25]), np.float32([[0, 0, 0], [0.3, -1.2, 0]])
    # Per vertex, per corner, per triangle.
    for shape in ((len(positions), 3), (len(triangles), 3, 3), (len(triangles), 3)):
        found = pel.surface_integral(device, positions, triangles, np.broadcast_to(light, shape), points)
        assert np.allclose(found, light, atol=3e-4)
    out = np.zeros((2, 3), np.float32)
    pel.submit_surface_integral(device, positions, triangles, np.broadcast_to(light, (len(positions), 3)),
                                points, out, profile="marble", cut=[2, 2, 2]).wait()
    assert np.allclose(out, light, atol=3e-4)
    with pytest.raises(ValueError, match="irradiance has shape"):
        pel.surface_integral(device, positions, triangles, light, points)
    with pytest.raises(pel.PellucidError, match="tolerance"):
        pel.surface_integral(device, positions, triangles, np.zeros_like(positions), points, tolerance=0)


def test_flip():
    y, x, c = np.mgrid[:32, :40, :3]
    plain = 0.5 + 0.4 * np.sin(0.3 * x + 0.2 * y + c)
    # flip-evaluator 1.7: 0.0631269 (tests/io/test_flip.cpp has more)
    assert pel.flip(plain, 0.98 * plain) == pytest.approx(0.0631269, abs=3e-5)
    assert pel.flip(plain, plain) == 0
    for wrong in (plain[0], plain[:0]):
        with pytest.raises(ValueError, match="height, width, 3"):
            pel.flip(wrong, wrong)
    with pytest.raises(ValueError, match="shape"):
        pel.flip(plain, plain[:3])


def test_compare():
    a = np.zeros((4, 5, 3), np.float32)
    b = a.copy()
    b[..., 1] = 0.25
    d = pel.compare(b, a)
    assert d["pixels"] == 20 and d["rmse"] == [0, 0.25, 0]
    assert d["mean"] == [0, 0.25, 0] and d["max"] == [0, 0.25, 0]
    assert d["rmse_all"] == pytest.approx(0.25 / 3**0.5) and d["delta_e_mean"] > 10
    b[0, 0] = np.nan
    d = pel.compare(b, a, mask=np.arange(20).reshape(4, 5) < 5)
    assert d["pixels"] == 4 and d["invalid_pixels"] == 1
    assert pel.compare(a, a)["psnr"] == float("inf")
    for wrong in (a[:2], a[..., :2]):
        with pytest.raises(ValueError, match="shape"):
            pel.compare(a, wrong)
    with pytest.raises(ValueError, match="mask"):
        pel.compare(a, a, mask=np.ones((2, 2)))
