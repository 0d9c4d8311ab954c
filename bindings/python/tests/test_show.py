"""How objects show themselves."""
import io
import sys

import numpy as np
import pytest

import pellucid as pel
from pellucid import _show

Image = pytest.importorskip("PIL.Image", reason="pillow is not installed")


def pixels(png):
    return np.asarray(Image.open(io.BytesIO(png)))


def test_png_bytes_are_read_by_others():
    image = np.random.default_rng(2).integers(0, 256, (7, 5, 3), np.uint8)
    assert np.array_equal(pixels(_show.png(image)), image)
    assert _show.srgb([0, 0.0031308, 0.5, 1, 9, -1, np.nan]).tolist() == [0, 10, 188, 255, 255, 0, 0]


def test_a_table_shows_its_texels(device):
    lut = pel.Lut.curvature(device, width=16, height=8)
    assert repr(lut) == "<pellucid.Lut curvature, 16 x 8, skin>"
    assert np.array_equal(pixels(lut._repr_png_()), _show.srgb(lut.read()))


def test_plots(device):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    profile = pel.Profile.named("jade")
    assert repr(profile).startswith("<pellucid.Profile jade: burley, radius 5.57")
    axes = profile.plot()
    assert [line.get_color() for line in axes.lines] == ["red", "green", "blue"]
    assert [t.get_text() for t in axes.get_legend().get_texts()] == ["red", "green", "blue"]
    assert axes.get_title() == "jade" and axes.get_xlabel().startswith("distance (mm")
    r, y = axes.lines[0].get_data()
    assert 0.75 < np.trapezoid(y, r) < 1.01  # nearly all of the light
    assert pixels(profile._repr_png_()).std() > 5 and profile.plot(axes) is axes and len(axes.lines) == 6
    curvature = pel.Lut.curvature(device, width=8, height=8, radius_min=1, radius_max=25, axis="root").plot()
    shadow = pel.Lut.shadow(device, width=8, height=8, axis="linear", width_min=2, width_max=4).plot()
    specular = pel.Lut.specular(device, width=4, height=4).plot()
    eye = pel.Lut.eye(device, width=4, height=4, depth=2).plot()
    for labels, known in [(curvature.get_yticklabels(), ["0.04", "0.16", "0.36", "0.64", "1"]),
                          (curvature.get_xticklabels(), ["-1", "-0.5", "0", "0.5", "1"]),
                          (shadow.get_yticklabels(), ["0.25", "0.312", "0.375", "0.438", "0.5"]),
                          (specular.get_yticklabels(), ["0", "0.25", "0.5", "0.75", "1"]),
                          (eye.get_yticklabels(), ["0", "0.5", "1", "1.5", "2"])]:
        assert [t.get_text() for t in labels] == known
    assert curvature.get_xticks()[1] == pytest.approx(0.5 - 0.5 * 0.5**0.5)
    for axes in (curvature, shadow, specular, eye):
        axes.figure.canvas.draw()
        across, down = (label.get_window_extent() for label in (axes.xaxis.label, axes.yaxis.label))
        whole = axes.figure.bbox
        assert 0 <= across.x0 and across.x1 <= whole.x1 and 0 <= down.y0 and down.y1 <= whole.y1
    assert curvature.get_ylabel().endswith("1/mm") and shadow.get_xlabel() == "shadow"


def test_without_matplotlib_it_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(ImportError, match=r"pellucid\[plot\]"):
        pel.Profile.skin().plot()
    assert pel.Profile.skin()._repr_png_() is None
