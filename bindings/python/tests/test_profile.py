"""Diffusion profiles."""
import numpy as np
import pytest

import pellucid as pel


def test_gaussian_has_both_views():
    d = np.array([0.1, 1.0, 3.0])
    # weights are normalised per channel
    radial, spread = pel.Profile.gaussians([(2.0, (1, 2, 3))]).evaluate(d)
    assert np.allclose(radial, (np.exp(-d**2 / 4) / (4 * np.pi))[:, None], rtol=1e-6)
    assert np.allclose(spread, (np.exp(-d**2 / 4) / np.sqrt(4 * np.pi))[:, None], rtol=1e-6)


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


@pytest.mark.parametrize("use, error", [
    (lambda: pel.Profile.gaussians([]), pel.PellucidError),
    (lambda: pel.Profile.gaussians([(-1, 1)]), pel.PellucidError),
    (lambda: pel.Profile.gaussians([(1, (1, 1))]), ValueError),
    (lambda: pel.Profile.burley(0, 0.5), pel.PellucidError),
    (lambda: pel.Profile.dipole(1, 1, float("nan")), pel.PellucidError),
    (lambda: pel.Profile.table([0, 1], [[1, 1, 1]]), ValueError),
    (lambda: pel.Profile.skin("x" * 64), pel.PellucidError),
    (lambda: pel.Profile(), TypeError)])
def test_bad_profiles(use, error):
    with pytest.raises(error):
        use()
