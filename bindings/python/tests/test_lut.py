"""Look-up tables, against the integrals written out again in NumPy."""
import io
import struct

import numpy as np
import pytest

import pellucid as pel

# The skin profile of GPU Gems 3, ch. 14, with the standard deviations (mm) of FaceWorks; weights per channel.
VARIANCES = np.array([0.080, 0.220, 0.432, 0.753, 1.411, 2.722]) ** 2
WEIGHTS = np.array([[.233, .455, .649], [.100, .336, .344], [.118, .198, 0], [.113, .007, .007], [.358, .004, 0],
                    [.078, 0, 0]])


def line_spread(s):
    gaussians = np.exp(-s[:, None] ** 2 / (2 * VARIANCES)) / np.sqrt(2 * np.pi * VARIANCES)
    return gaussians @ (WEIGHTS / WEIGHTS.sum(0))


def integrate(lengths, values):
    """Simpson's rule; an odd number of equally spaced points."""
    w = np.ones(len(lengths))
    w[1:-1:2], w[2:-1:2] = 4, 2
    return (w[:, None] * values).sum(0) * (lengths[1] - lengths[0]) / 3


def test_curvature_texels_are_the_integral(device, tolerance):
    texels = pel.Lut.curvature(device, width=64, height=16, preset="faceworks").read()
    assert texels.shape == (16, 64, 3) and texels.dtype == np.float32
    for x, y in [(0, 0), (31, 15), (35, 8), (20, 15), (63, 3)]:
        u = -1 + (x + 0.5) * 2 / 64
        r = 1 / (0.01 + (y + 0.5) * (1 - 0.01) / 16)
        edge = min(np.pi * r, 10.0)
        # Split at the terminator's kinks, theta - s / r = ±90° (and ±270°), so that each piece is smooth.
        theta = np.arccos(u)
        kinks = [r * (theta - k * np.pi / 2) for k in (-3, -1, 1, 3)]
        ends = sorted({-edge, 0.0, edge, *(k for k in kinks if -edge < k < edge)})
        truth = np.zeros(3)
        for low, high in zip(ends, ends[1:]):
            s = np.linspace(low, high, 4001)
            middle = (s[1:] + s[:-1]).mean() / 2
            if np.cos(theta - middle / r) > 0:
                truth += integrate(s, np.cos(theta - s / r)[:, None] * line_spread(s))
        assert np.abs(texels[y, x] - truth).max() < tolerance["lutTexel"], (x, y)


def test_encodings(device):
    lut = pel.Lut.curvature(device, width=32, height=8, radius_min=0.5, preset="faceworks")
    full = lut.read("float")
    assert np.array_equal(lut.read("half"), full.astype(np.float16))
    coded = lut.read(pel.LutEncoding.FACEWORKS8)
    u = -1 + (np.arange(32) + 0.5) * 2 / 32
    exact = 255 * np.clip(2 * (full.astype(float) - np.maximum(u, 0)[None, :, None]) + 0.5, 0, 1)
    assert coded.shape == (8, 32, 4) and (coded[..., 3] == 255).all()
    assert np.abs(coded[..., :3] - exact).max() <= 0.5 + 1e-4
    residual = full.astype(float) - np.maximum(u, 0)[None, :, None]
    assert lut.clipped_texels() == (np.abs(residual) > 0.25).any(axis=2).sum() > 0
    assert lut.info.curvature.radius_min == 0.5 and lut.info.kind is pel.LutKind.CURVATURE


def test_bc6h_is_as_near_as_it_says(device, tolerance):
    lut = pel.Lut.curvature(device, width=62, height=31, axis="root", preset="faceworks")
    blocks, error_max, error_rms = lut.read_bc6h()
    assert blocks.shape == (8, 16, 16) and blocks.dtype == np.uint8 and blocks.flags.writeable
    halves = lut.read("half").astype(float)
    assert 0 < error_rms < error_max < 0.02 and error_rms < 2e-3
    image = pytest.importorskip("PIL.Image")
    # Another reader: Pillow decodes to 8 bits, which adds half a step.
    header = struct.pack("<4s7I44x", b"DDS ", 124, 0x81007, 31, 62, blocks.nbytes, 0, 1)
    header += struct.pack("<2I4s20x2I12x", 32, 4, b"DX10", 0x1000, 0) + struct.pack("<5I", 95, 3, 0, 1, 0)
    seen = np.asarray(image.open(io.BytesIO(header + blocks.tobytes())).convert("RGB")).astype(float)
    assert seen.shape == halves.shape
    assert np.abs(seen / 255 - np.clip(halves, 0, 1)).max() < error_max + 1.1 / 255
    assert np.array_equal(lut.read_bc6h()[0], blocks)


def test_measured_profiles(device):
    # A thin disk scatters evenly within its radius: P(s) = 2 sqrt(1 - s^2) / pi for radius 1.
    disk = pel.Profile.table([0.5, 1], [[1, 1, 1]] * 2)
    lut = pel.Lut.curvature(device, width=65, height=1, radius_min=2, radius_max=2, form="arc",
                            profile=disk)
    s = np.sin(np.linspace(-np.pi / 2, np.pi / 2, 20001))
    weight = 2 / np.pi * (1 - s**2) * np.pi / 20000
    for x in range(0, 65, 8):
        side = -1 + 2 * x / 64
        theta = np.arccos(side * abs(side))
        assert abs(lut.read()[0, x, 0] - (np.maximum(np.cos(theta - s / 2), 0) * weight).sum()) < 1e-5
    assert lut.info.profile == "table"
    shadow = pel.Lut.shadow(device, width=64, height=4, profile=disk, preset="faceworks").read()
    assert (np.diff(shadow, axis=1) >= -1e-6).all() and abs(shadow[:, ::-1] + shadow - 1).max() < 1e-5


def test_shadow_is_monotone_and_ends_dark_and_lit(device):
    texels = pel.Lut.shadow(device, width=64, height=8).read()
    assert (np.diff(texels, axis=1) >= -1e-6).all()
    assert np.abs(texels[:, 0]).max() < 1e-6 and np.abs(texels[:, -1] - 1).max() < 1e-6
    texels = pel.Lut.shadow(device, width=64, height=8, preset="faceworks").read()
    assert (np.diff(texels, axis=1) >= -1e-6).all()
    assert 0 < texels[:, 0].max() < 0.5 < texels[:, -1].min() < 1


def test_defaults_follow_from_the_profile(device):
    for name in ("skin", "marble"):
        profile = pel.Profile.named(name).info
        curvature = pel.Lut.curvature(device, profile=name).info.curvature
        assert (curvature.width, curvature.height) == (64, 64)
        assert curvature.form is pel.CurvatureForm.SPHERE and curvature.axis is pel.LutAxis.ROOT
        assert curvature.diffusion_radius == profile.radius
        assert curvature.radius_min == pytest.approx(0.25 * profile.radius)
        assert curvature.radius_max == pytest.approx(1000 * profile.radius)
        shadow = pel.Lut.shadow(device, profile=name).info.shadow
        assert (shadow.width, shadow.height, shadow.closed_ends) == (128, 32, 1) and shadow.axis is pel.LutAxis.ROOT
        assert shadow.width_min == pytest.approx(1.3 * max(profile.width))
        assert shadow.width_max == pytest.approx(1000 * shadow.width_min)
    stretched = pel.Lut.shadow(device, diffusion_radius=27).info.shadow  # skin in tenths of a millimetre
    assert stretched.width_min == pytest.approx(10 * pel.Lut.shadow(device).info.shadow.width_min, rel=1e-3)


def test_faceworks_is_a_preset(device):
    info = pel.Lut.curvature(device, preset="faceworks").info.curvature
    assert (info.width, info.height, info.radius_min, info.radius_max) == (512, 512, 1, 100)
    assert info.form is pel.CurvatureForm.ARC and info.axis is pel.LutAxis.LINEAR
    info = pel.Lut.shadow(device, preset="faceworks").info.shadow
    assert (info.width, info.height, info.width_min, info.width_max, info.closed_ends) == (512, 512, 8, 100, 0)
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


def test_specular_is_beckmann(device, tolerance):
    texels = pel.Lut.specular(device, width=64, height=32).read()
    nh, m = (np.arange(64) + 0.5) / 64, ((np.arange(32) + 0.5) / 32)[:, None]
    tan2 = 1 / nh**2 - 1
    assert np.abs(texels[..., 0] - 0.5 * (np.exp(-tan2 / m**2) / (m**2 * nh**4)) ** 0.1).max() < tolerance["lutTexel"] * 10


def test_profiles_reach_the_table(device):
    narrow = pel.Profile.gaussians([(0.01, 1)], name="narrow")
    lut = pel.Lut.curvature(device, width=64, height=8, profile=narrow, preset="faceworks")
    assert lut.info.profile == "narrow"
    u = -1 + (np.arange(64) + 0.5) * 2 / 64
    # sigma is 0.1: at radius 1 it smears the terminator by about 0.1 and no more.
    assert np.abs(lut.read() - np.maximum(u, 0)[None, :, None]).max() < 0.05
    again = pel.Lut.from_texels(device, lut.info, lut.read())
    del lut, narrow
    assert again.info.profile == "narrow"


def test_bad_use(device):
    with pytest.raises(AttributeError, match="no field 'widht'"):
        pel.Lut.curvature(device, widht=3)
    with pytest.raises(ValueError, match="encoding is 'png'; it must be one of float, half, faceworks8"):
        pel.Lut.curvature(device, width=4, height=4).read("png")
    with pytest.raises(ValueError, match="out is"):
        pel.Lut.curvature(device, width=4, height=4).read("half", np.empty((4, 4, 3), np.float32))
    with pytest.raises(TypeError):
        pel.Lut()
