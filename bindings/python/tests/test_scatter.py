"""Scattering alone."""
import numpy as np
import pytest

import pellucid as pel


def ball(radius=10.0, size=0.25):
    y, x = (np.mgrid[0:80, 0:80] - 39.5) * size
    inside = x**2 + y**2 < radius**2
    z = np.sqrt(np.where(inside, radius**2 - x**2 - y**2, 0))
    positions = np.stack([x, y, z], -1).astype(np.float32)
    irradiance = np.repeat(np.clip(positions[..., :1] / radius, 0, 1) * inside[..., None], 3,
                           -1).astype(np.float32)
    return irradiance, positions, inside.astype(np.uint8)


def test_execute_submit_and_in_place(device):
    irradiance, positions, ids = ball()
    scatter = pel.Scatter(device)
    assert np.array_equal(scatter.execute(irradiance, positions, ids=ids), irradiance)
    scatter.set_material(1, pel.Profile.skin())
    result = scatter.execute(irradiance, positions, ids=ids)
    assert np.array_equal(result[ids == 0], irradiance[ids == 0])
    dark = (ids == 1) & (positions[..., 0] > -1) & (positions[..., 0] < 0)
    # red reaches furthest
    assert (result[dark, 0] > result[dark, 2]).all() and irradiance[dark].max() == 0 < result[dark, 0].min()
    stats = scatter.stats()
    assert 0 < stats.pixels_tapped <= stats.pixels_covered == ids.sum()
    later = np.empty_like(irradiance)
    scatter.submit_execute(irradiance, positions, later, ids=ids).wait()
    assert np.array_equal(later, result)
    scatter.execute(irradiance, positions, ids=ids, out=irradiance)
    assert np.array_equal(irradiance, result)


def test_materials_controls_and_images(device):
    irradiance, positions, ids = ball()
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
    for call, message in [
            (lambda: scatter.set_image("curvature", np.ones(ids.shape, np.float32)), "none that a Pel"),
            (lambda: scatter.set_material(300, pel.Profile.skin()), "1 to 255"),
            (lambda: scatter.set_controls(1, scatter_taps=3), "scatterTaps is 3")]:
        with pytest.raises(pel.PellucidError, match=message):
            call()
    scatter.set_material(1, None)
    with pytest.raises(pel.PellucidError, match="is not set"):
        scatter.set_controls(1, scatter_taps=8)
