"""Skin by what it is made of. Its numbers: tests/lut/test_reference_skin.cpp."""
import numpy as np
import pytest

import pellucid


def test_a_profile_and_its_numbers():
    skin = pellucid.Skin(melanin=0.1, blood=0.02)
    assert (pellucid.skin_info(skin, melanin=0.2).albedo < pellucid.skin_info(skin).albedo).all()
    assert skin.melanin == np.float32(0.1)
    info = pellucid.Profile.skin_layers(skin, name="brown").info
    assert (info.kind, info.name) == (pellucid.ProfileKind.SKIN_LAYERS, "brown")
    at = np.arange(380, 721, 5)
    assert (pellucid.skin_reflectance(at, skin, melanin=0.2) < pellucid.skin_reflectance(at, skin)).all()
    with pytest.raises(pellucid.PellucidError, match="melanin"):
        pellucid.skin_info(melanin=0.6)


def test_maps_and_back():
    melanin, blood = np.meshgrid(np.linspace(0, 0.4, 9), np.linspace(0.001, 0.15, 7))
    albedo, radius = pellucid.skin_albedo(melanin, blood)
    assert (albedo.shape, radius.shape) == ((7, 9, 3), (7, 9)) and (np.diff(radius, axis=1) < 0).all()
    found = pellucid.skin_from_albedo(albedo)
    np.testing.assert_allclose(found[:2], (melanin, blood), atol=0.005)
    one = pellucid.skin_from_albedo(albedo[3, 4])  # a single colour
    np.testing.assert_array_equal(one, [a[3, 4] for a in found])
    with pytest.raises(ValueError, match="albedo has the shape"):
        pellucid.skin_from_albedo(np.zeros((2, 2)))
