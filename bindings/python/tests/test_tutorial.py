"""The tutorial, as its first lines say to run it."""
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

TUTORIAL = Path(__file__).resolve().parents[3] / "examples/tutorial.py"


def test_mesh_to_picture(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("embreex")
    pytest.importorskip("scipy")
    image = pytest.importorskip("PIL.Image")
    mesh = trimesh.creation.icosphere(subdivisions=4)
    mesh.export(tmp_path / "ball.off")  # without normals
    subprocess.run([sys.executable, TUTORIAL, tmp_path / "ball.off", tmp_path / "ball.png"], check=True, timeout=120)
    picture = np.asarray(image.open(tmp_path / "ball.png")).astype(int)
    assert picture.shape == (360, 720, 3)
    plain, scattered = picture[:, :360], picture[:, 360:]
    # Light from +x: bright there in both, and red light crosses the terminator on the right only.
    assert plain[180, 330].min() > 100 and plain[180, 160].max() < 90
    lit = (plain.sum(-1) > 0) & (scattered.sum(-1) > 0)
    assert lit.sum() > 20000
    crossed = (plain.max(-1) == 0) & (scattered[..., 0] > scattered[..., 2])
    assert crossed.sum() > 200 and scattered[crossed][:, 0].max() > 15


def test_it_is_short():
    code = re.sub(r'""".*?"""', "", TUTORIAL.read_text(), flags=re.S).splitlines()
    assert sum(bool(line.strip()) and not line.startswith("#") for line in code) < 40
