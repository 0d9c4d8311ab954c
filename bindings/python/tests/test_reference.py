"""The surface integral from Python."""
import numpy as np
import pytest

import pellucid as pel


def test_surface_integral_of_an_evenly_lit_sheet(device):
    # Far from its border a plane gives back what it gets, whatever the profile.
    x, y = np.meshgrid(np.linspace(-30, 30, 41), np.linspace(-30, 30, 41))
    positions = np.stack([x, y, np.zeros_like(x)], -1).reshape(-1, 3).astype(np.float32)
    a = (np.arange(40)[:, None] * 41 + np.arange(40)).ravel()
    triangles = np.vstack([np.stack([a, a + 1, a + 41], 1), np.stack([a + 1, a + 42, a + 41], 1)])
    light = np.array([1, 0.5, 0.25], np.float32)
    points = np.array([[0, 0, 0], [0.3, -1.2, 0]], np.float32)
    # Per vertex, per corner, per triangle.
    for shape in ((len(positions), 3), (len(triangles), 3, 3), (len(triangles), 3)):
        found = pel.surface_integral(device, positions, triangles, np.broadcast_to(light, shape), points)
        assert np.allclose(found, light, atol=3e-4)
    out = np.zeros((2, 3), np.float32)
    pel.submit_surface_integral(device, positions, triangles, np.broadcast_to(light, (len(positions), 3)),
                                points, out,
                                profile=pel.Profile.burley([1, 1, 1], [0.8, 0.8, 0.8]), cut=[2, 2, 2]).wait()
    assert np.allclose(out, light, atol=3e-4)
    slanted = (positions[:, :1] > 0) * light
    plain = pel.surface_integral(device, positions, triangles, slanted, points)
    pel.submit_surface_integral(device, positions, triangles, slanted, points, out).wait()
    assert np.array_equal(out, plain), "the same defaults with and without waiting"
    with pytest.raises(ValueError, match="irradiance has shape"):
        pel.surface_integral(device, positions, triangles, light, points)
    with pytest.raises(pel.PellucidError, match="tolerance"):
        pel.surface_integral(device, positions, triangles, np.zeros_like(positions), points, tolerance=0)


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
