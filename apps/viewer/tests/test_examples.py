"""The examples that use OpenGL, as their first lines say to run them."""
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
files = pytest.importorskip("pellucid.files", reason="this build reads no files")
moderngl = pytest.importorskip("moderngl", reason="moderngl is not installed")


def picture(path):
    image = files.read_image(path)
    return np.stack([image[c] for c in "RGB"], -1)


def run(example, *arguments):
    try:
        moderngl.create_standalone_context(backend="egl", require=330).release()
    except Exception as error:
        pytest.skip(f"no OpenGL: {error}")
    made = subprocess.run([sys.executable, EXAMPLES / example, *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=300)
    assert made.returncode == 0, made.stdout
    return picture(arguments[0])


def test_tutorial(tmp_path):
    found = run("tutorial.py", tmp_path / "head.png")
    known = picture(EXAMPLES / "tutorial.png")
    assert found.shape == known.shape == (480, 960, 3)
    # Drivers may put edges of triangles half a pixel apart.
    off = np.abs(found - known).max(-1)
    assert off.mean() < 0.002 and (off > 0.05).mean() < 0.01
    plain, scattered = found[:, :480], found[:, 480:]
    covered = plain.max(-1) > 0.02
    assert 0.3 < covered.mean() < 0.8
    # Red light crosses the terminator, blue hardly: scattering shifts dark places to red.
    dark = covered & (plain.max(-1) < 0.3)
    gain = (scattered - plain)[dark].mean(0)
    assert gain[0] > gain[2] + 0.002


def test_up(tmp_path):
    """A long box that stands: as tall in the picture along its up axis, whichever that is."""
    z = np.array([[x, y, z] for z in (0, 4) for y in (0, 1) for x in (0, 1)], float)
    faces = ["0 3 1", "0 2 3", "4 5 7", "4 7 6", "0 1 5", "0 5 4", "2 7 3", "2 6 7", "0 4 6", "0 6 2",
             "1 3 7", "1 7 5"]
    shapes = {}
    for up, points in (("z", z), ("y", z[:, [0, 2, 1]] * [1, 1, -1])):
        path = tmp_path / f"box_{up}.off"
        path.write_text("OFF\n8 12 0\n" + "\n".join(" ".join(map(str, p)) for p in points) + "\n" +
                        "\n".join("3 " + f for f in faces) + "\n")
        seen = run("tutorial.py", tmp_path / f"box_{up}.png", path, "--up", up)[:, :480].max(-1) > 0.02
        rows, columns = seen.any(1).sum(), seen.any(0).sum()
        assert rows > 2 * columns
        shapes[up] = (rows, columns)
    assert np.abs(np.subtract(shapes["y"], shapes["z"])).max() <= 2


def test_opengl_host_draws_a_ring_and_its_shadow(tmp_path):
    image = run("opengl_host.py", tmp_path / "ring.png")
    assert image.shape == (540, 960, 3)
    green = (image[..., 1] > 1.15 * image[..., 0]) & (image[..., 1] > 0.2)
    rows, columns = np.nonzero(green)
    # The ring is about the middle of the picture, with a hole, and wider than high: seen from above.
    assert 0.05 < green.mean() < 0.3
    assert abs(columns.mean() - 480) < 30 and not green[rows.min() + (rows.max() - rows.min()) // 2,
                                                        470:490].all()
    # Its shadow falls on the wall to the left and down; where the light comes from, the wall is lit.
    grey = ~green & (image.max(-1) > 0.02)
    left, right = image[:, :480].mean(-1)[grey[:, :480]], image[:, 480:].mean(-1)[grey[:, 480:]]
    dark = np.median(image.mean(-1)[grey]) * 0.6
    assert (left < dark).sum() > 2 * (right < dark).sum() + 500
