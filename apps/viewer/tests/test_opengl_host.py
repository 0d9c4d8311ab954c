"""The example of an OpenGL host, as its first lines say to run it."""
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

EXAMPLE = Path(__file__).resolve().parents[3] / "examples/opengl_host.py"
files = pytest.importorskip("pellucid.files", reason="this build reads no files")
moderngl = pytest.importorskip("moderngl", reason="moderngl is not installed")


def test_it_draws_a_ring_and_its_shadow(tmp_path):
    try:
        moderngl.create_standalone_context(backend="egl", require=330).release()
    except Exception as error:
        pytest.skip(f"no OpenGL: {error}")
    made = subprocess.run([sys.executable, EXAMPLE, tmp_path / "ring.png"], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=300)
    assert made.returncode == 0, made.stdout
    image = files.read_image(tmp_path / "ring.png")
    picture = np.stack([image[c] for c in "RGB"], -1)
    assert picture.shape == (540, 960, 3)
    green = (picture[..., 1] > 1.15 * picture[..., 0]) & (picture[..., 1] > 0.2)
    rows, columns = np.nonzero(green)
    # The ring is about the middle of the picture, with a hole, a little wider than high for the camera looks
    # down on it.
    assert 0.05 < green.mean() < 0.3
    assert abs(columns.mean() - 480) < 30 and not green[rows.min() + (rows.max() - rows.min()) // 2,
                                                        470:490].all()
    # Its shadow falls on the wall, away from the light: to the left and down. Where the light comes from,
    # the wall is lit.
    grey = ~green & (picture.max(-1) > 0.02)
    left, right = picture[:, :480].mean(-1)[grey[:, :480]], picture[:, 480:].mean(-1)[grey[:, 480:]]
    dark = np.median(picture.mean(-1)[grey]) * 0.6
    assert (left < dark).sum() > 2 * (right < dark).sum() + 500
