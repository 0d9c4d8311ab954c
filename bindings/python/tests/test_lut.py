"""Look-up tables: what is asked for, and texels in every form."""



import numpy as np
import pytest

import pellucid as pel


def test_faceworks_is_a_preset(device):
    info = pel.Lut.curvature(device, preset="faceworks").info.curvature
    assert (info.width, info.height, info.radius_min, info.radius_max) == (512, 512, 1, 100)
    assert info.form is pel.CurvatureForm.ARC and info.axis is pel.LutAxis.LINEAR
    info = pel.Lut.shadow(device, preset="faceworks").info.shadow
    assert (info.width, info.height, info.width_min, info.width_max, info.closed_ends) == (
        512, 512, 8, 100, 0)
    assert info.axis is pel.LutAxis.LINEAR
    with pytest.raises(ValueError, match="it must be one of material, faceworks"):
        pel.Lut.curvature(device, preset="unreal")
    with pytest.raises(ValueError, match="exclude"):
        pel.Lut.curvature(device, pel.CurvatureLutDesc(), preset="faceworks")


def test_submitted_tables_are_the_same(device):
    lut = pel.Lut.curvature(device, width=128, height=64, wait=False)
    out = np.empty((64, 128, 3), np.float32)
    lut.submit_read("float", out, waits=[lut.ready]).wait()
    assert np.array_equal(out, pel.Lut.curvature(device, width=128, height=64).read())


def test_texels_go_there_and_back(device):
    lut = pel.Lut.shadow(device, width=16, height=4)
    texels = lut.read()
    assert np.array_equal(pel.Lut.from_texels(device, lut.info, texels).read(), texels)
    with pytest.raises(pel.PellucidError):
        pel.Lut.from_texels(device, lut.info, texels[:-1])
    with pytest.raises(ValueError, match="float64"):
        pel.Lut.from_texels(device, lut.info, texels.astype(np.float64))


@pytest.mark.parametrize("fields", [dict(width=0), dict(radius_min=-1.0), dict(radius_max=float("nan")),
                                    dict(diffusion_radius=-2.0)])
def test_bad_descriptions(device, fields):
    with pytest.raises(pel.PellucidError) as caught:
        pel.Lut.curvature(device, **fields)
    assert caught.value.code is pel.ErrorCode.INVALID_ARGUMENT and str(caught.value)


def test_bad_use(device):
    with pytest.raises(AttributeError, match="no field 'widht'"):
        pel.Lut.curvature(device, widht=3)
    with pytest.raises(ValueError, match="encoding is 'png'; it must be one of float, half, faceworks8"):
        pel.Lut.curvature(device, width=4, height=4).read("png")
    with pytest.raises(ValueError, match="out is"):
        pel.Lut.curvature(device, width=4, height=4).read("half", np.empty((4, 4, 3), np.float32))
    with pytest.raises(TypeError):
        pel.Lut()


def test_encodings(device):
    lut = pel.Lut.curvature(device, width=32, height=8, radius_min=0.5, preset="faceworks")
    full = lut.read("float")
    assert full.shape == (8, 32, 3) and full.dtype == np.float32
    assert np.array_equal(lut.read("half"), full.astype(np.float16))
    coded = lut.read(pel.LutEncoding.FACEWORKS8)
    assert coded.shape == (8, 32, 4) and (coded[..., 3] == 255).all()
    outside = np.abs(full - np.maximum(-1 + (np.arange(32) + 0.5) / 16, 0)[None, :, None]) > 0.25
    assert lut.clipped_texels() == outside.any(axis=2).sum() > 0
    assert lut.info.curvature.radius_min == 0.5 and lut.info.kind is pel.LutKind.CURVATURE
    blocks, largest, rms = lut.read_bc6h()
    assert blocks.shape == (2, 8, 16) and blocks.dtype == np.uint8 and 0 < rms < largest < 0.1


def test_a_profile_goes_along_with_its_table(device):
    narrow = pel.Profile.gaussians([(0.01, 1)], name="narrow")
    lut = pel.Lut.curvature(device, width=64, height=8, profile=narrow, preset="faceworks")
    again = pel.Lut.from_texels(device, lut.info, lut.read())
    del lut, narrow
    assert again.info.profile == "narrow"
