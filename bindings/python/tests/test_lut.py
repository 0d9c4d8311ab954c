"""Diffusion profiles, and look-up tables: presets, errors, and texels in every form."""
import numpy as np
import pytest

import pellucid as pel


def test_texels_go_there_and_back(device):
    lut = pel.Lut.shadow(device, width=16, height=4, wait=False)
    texels = np.empty((4, 16, 3), np.float32)
    lut.submit_read("float", texels, waits=[lut.ready]).wait()
    waited = pel.Lut.shadow(device, width=16, height=4)
    assert waited.ready is None and np.array_equal(texels, waited.read())
    assert np.array_equal(pel.Lut.from_texels(device, lut.info, texels).read(), texels)
    with pytest.raises(pel.PellucidError):
        pel.Lut.from_texels(device, lut.info, texels[:-1])
    with pytest.raises(ValueError, match="float64"):
        pel.Lut.from_texels(device, lut.info, texels.astype(np.float64))
    jade = pel.LutInfo(kind="shadow", shadow=pel.ShadowLutDesc(profile="jade", width=16, height=4)).copy()
    assert jade.shadow.profile.info.name == pel.Lut.from_texels(device, jade, texels).info.profile == "jade"


@pytest.mark.parametrize("use, error, message", [
    (lambda d: pel.Lut.curvature(d, radius_max=float("nan")), pel.PellucidError, "radiusMax"),
    (lambda d: pel.Lut.curvature(d, widht=3), AttributeError, "no field 'widht'"),
    (lambda d: pel.Lut.curvature(d, preset="unreal"), ValueError, "it must be one of material, faceworks"),
    (lambda d: pel.Lut.curvature(d, pel.CurvatureLutDesc(), preset="faceworks"), ValueError, "exclude"),
    (lambda d: pel.Lut.curvature(d, width=4, height=4).read("png"), ValueError,
     "encoding is 'png'; it must be one of float, half, faceworks8"),
    (lambda d: pel.Lut.curvature(d, width=4, height=4).read("half", np.empty((4, 4, 3), np.float32)),
     ValueError, "out is"),
    (lambda d: pel.Lut.read_stack(d, []), ValueError, "empty"),
    (lambda d: pel.Lut.read_stack(d, [pel.LutInfo()]), TypeError, "ShadowLutDesc is needed"),
    (lambda d: pel.Lut.read_stack(d, [pel.ShadowLutDesc(), pel.CurvatureLutDesc()]), TypeError, "needed"),
    (lambda d: pel.Lut.read_stack(d, [pel.ShadowLutDesc(width=w) for w in (3, 4)]), pel.PellucidError,
     "in width"),
    (lambda d: pel.Lut(), TypeError, "Lut.curvature")])
def test_bad_use(device, use, error, message):
    with pytest.raises(error, match=message):
        use(device)


def test_encodings_of_the_preset_of_faceworks(device):
    shadow = pel.Lut.shadow(device, preset="faceworks").info.shadow
    assert (shadow.width, shadow.width_min, shadow.closed_ends) == (512, 8, 0)
    lut = pel.Lut.curvature(device, width=32, height=8, radius_min=0.5, preset="faceworks")
    full = lut.read("float")
    assert full.shape == (8, 32, 3) and full.dtype == np.float32
    assert np.array_equal(lut.read("half"), full.astype(np.float16))
    coded = lut.read(pel.LutEncoding.FACEWORKS8)
    assert coded.shape == (8, 32, 4) and (coded[..., 3] == 255).all()
    assert lut.clipped_texels() > 0
    info = lut.info.curvature
    assert info.radius_min == 0.5 and lut.info.kind is pel.LutKind.CURVATURE
    assert info.form is pel.CurvatureForm.ARC and info.axis is pel.LutAxis.LINEAR


def test_a_profile_goes_along_with_its_table(device):
    narrow = pel.Profile.gaussians([(0.01, 1)], name="narrow")
    lut = pel.Lut.curvature(device, width=64, height=8, profile=narrow, preset="faceworks")
    again = pel.Lut.from_texels(device, lut.info, lut.read())
    del lut, narrow
    assert again.info.profile == "narrow"


def test_profiles():
    d = np.array([0.1, 1.0, 3.0])
    radial, spread = pel.Profile.gaussians([(2.0, (1, 2, 3))]).evaluate(d)
    assert radial.shape == (3, 3) and np.allclose(spread[:, 0], np.exp(-d**2 / 4) / np.sqrt(4 * np.pi))
    info = pel.Profile.skin("mine").info
    assert info.kind is pel.ProfileKind.SKIN and info.name == "mine" and info.radius == np.float32(2.7)
    assert info.normal_blend[0] == 1
    assert {"skin", "marble"} <= set(pel.Profile.library_names())
    info = pel.Profile.named("marble").info
    assert info.name == "marble" and info.source and info.reach > 0


@pytest.mark.parametrize("use, error", [
    (lambda: pel.Profile.named("granite"), pel.PellucidError),
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


@pytest.mark.parametrize("encoding", ["float", "half", "faceworks8"])
def test_tables_of_a_stack_are_those_of_their_own(device, encoding):
    profiles = [pel.Profile.skin_layers(pel.Skin(melanin=m)) for m in (0.02, 0.1, 0.3)]
    for make, kind in ((pel.Lut.curvature, pel.CurvatureLutDesc), (pel.Lut.shadow, pel.ShadowLutDesc)):
        descs = [kind(profile=profile, width=16, height=8) for profile in profiles]
        stack = pel.Lut.read_stack(device, descs, encoding)
        assert np.array_equal(stack, [make(device, desc).read(encoding) for desc in descs])
        assert not np.array_equal(stack[0], stack[2])
