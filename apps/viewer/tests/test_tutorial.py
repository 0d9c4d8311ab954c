"""The tutorial, as its first lines say to run it, and its picture against the one that was looked at."""
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

TUTORIAL = Path(__file__).resolve().parents[3] / "examples/tutorial.py"
files = pytest.importorskip("pellucid.files", reason="this build reads no files")
pytest.importorskip("moderngl", reason="moderngl is not installed")


def run(*arguments):
    made = subprocess.run([sys.executable, TUTORIAL, *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=300)
    if made.returncode and "OpenGL" in made.stdout:
        pytest.skip("no OpenGL")
    assert made.returncode == 0, made.stdout
    image = files.read_image(arguments[0])
    return np.stack([image[c] for c in "RGB"], -1)


def test_its_picture(tmp_path):
    found = run(tmp_path / "head.png")
    image = files.read_image(TUTORIAL.with_suffix(".png"))
    known = np.stack([image[c] for c in "RGB"], -1)
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
        picture = run(tmp_path / f"box_{up}.png", path, "--up", up)[:, :480].max(-1) > 0.02
        rows, columns = picture.any(1).sum(), picture.any(0).sum()
        assert rows > 2 * columns
        shapes[up] = (rows, columns)
    assert np.abs(np.subtract(shapes["y"], shapes["z"])).max() <= 2
