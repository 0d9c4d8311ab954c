"""Diffusion profiles."""
import numpy as np
import pytest

import pellucid as pel


def test_gaussian_has_both_views():
    d = np.array([0.1, 1.0, 3.0])
    radial, spread = pel.Profile.gaussians([(2.0, (1, 2, 3))]).evaluate(d)  # weights are normalised per channel
    assert np.allclose(radial, (np.exp(-d**2 / 4) / (4 * np.pi))[:, None], rtol=1e-6)
    assert np.allclose(spread, (np.exp(-d**2 / 4) / np.sqrt(4 * np.pi))[:, None], rtol=1e-6)


@pytest.mark.parametrize("make", [
    lambda: pel.Profile.skin(), lambda: pel.Profile.burley((1, 0.5, 0.3), 0.8, "searchlight"),
    lambda: pel.Profile.dipole(0.1, (2, 3, 4), 1.3),
    lambda: pel.Profile.table(np.linspace(0, 4, 30), np.exp(-np.linspace(0, 4, 30))[:, None] * [1, 2, 3])])
def test_energy_is_one(make):
    # The line spread, over s in (0, 200), on a scale that resolves both ends.
    s = np.exp(np.linspace(np.log(1e-6), np.log(200), 40001))
    _, spread = make().evaluate(s)
    y = spread * s[:, None]
    energy = 2 * (y[1:] + y[:-1]).sum(0) / 2 * np.log(s[1] / s[0])
    assert np.abs(energy - 1).max() < 2e-3


def test_info_and_name():
    info = pel.Profile.skin("mine").info
    assert info.kind is pel.ProfileKind.SKIN and info.name == "mine" and info.radius == np.float32(2.7)
    assert info.normal_blend[0] == 1


def test_named_profiles():
    names = pel.Profile.library_names()
    assert names[0] == "skin" and "marble" in names
    for name in names:
        info = pel.Profile.named(name).info
        assert info.name == name and info.source and info.reach > 0
    with pytest.raises(pel.PellucidError, match="marble"):
        pel.Profile.named("granite")


def test_burley_by_its_own_length_and_its_transmission():
    d = np.float32([0.9, 0.35, 0.2])
    s = np.array([0, 0.1, 1, 3])
    through = pel.Profile.burley_distance(d).transmission(s)
    assert np.allclose(through, np.exp(-s[:, None] / d) / 4 + np.exp(-s[:, None] / (3 * d)) * 3 / 4, rtol=1e-6)
    by_path = pel.Profile.burley(d * (1.9 - 0.5 + 3.5 * 0.3**2), 0.5)
    assert np.allclose(by_path.transmission(s), through, rtol=1e-5)
    assert by_path.info.mean_free_path.min() > 0 and not pel.Profile.burley_distance(d).info.mean_free_path.any()


@pytest.mark.parametrize("use, error", [
    (lambda: pel.Profile.gaussians([]), pel.PellucidError), (lambda: pel.Profile.gaussians([(-1, 1)]), pel.PellucidError),
    (lambda: pel.Profile.gaussians([(1, (1, 1))]), ValueError), (lambda: pel.Profile.burley(0, 0.5), pel.PellucidError),
    (lambda: pel.Profile.dipole(1, 1, float("nan")), pel.PellucidError),
    (lambda: pel.Profile.table([0, 1], [[1, 1, 1]]), ValueError), (lambda: pel.Profile.skin("x" * 64), pel.PellucidError),
    (lambda: pel.Profile(), TypeError)])
def test_bad_profiles(use, error):
    with pytest.raises(error):
        use()
