"""Meshes of which a part moves, and curvature of pictures."""
import numpy as np
import pytest

import pellucid as pel
from pellucid import _in_flight


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("given", [False, True])
def test_a_part_gives_the_bits_of_the_whole(device, moving_device, make_sphere, moving, given):
    d = moving_device if moving else device
    mesh = make_sphere(5.0)
    topology = pel.MeshTopology(d, mesh.triangles, len(mesh.positions))
    live = pel.LiveMesh(topology, pel.CurvatureParams(smoothing_passes=1))
    positions, normals = mesh.positions.copy(), mesh.normals if given else None
    out = np.empty(len(positions), np.float32)
    live.update(positions, normals, out)
    assert live.stats().rows_stored == len(positions)
    positions[500:503] *= 1.01
    live.update(positions, normals, out, [(500, 3)])
    anew = np.empty_like(out)
    pel.LiveMesh(topology, live.params).update(positions, normals, anew)
    assert np.array_equal(out, anew)
    if not moving:
        assert live.stats().rows_stored < len(positions) / 4
        launches = device.stats().launches
        live.update(positions, normals, out, [])
        assert device.stats().launches == launches and live.stats().launches == 0
    with pytest.raises(pel.PellucidError, match="range 0"):
        live.update(positions, normals, out, [(len(positions), 1)])


def test_screen_curvature_of_a_sphere(device, tolerance):
    radius = 8.0
    y, x = np.mgrid[-9:9:60j, -9:9:80j]
    inside = x**2 + y**2 < radius**2
    z = np.sqrt(np.where(inside, radius**2 - x**2 - y**2, 1))
    positions = np.stack([x, y, z], -1).astype(np.float32)
    normals = np.where(inside[..., None], positions / np.float32(radius), np.float32(0)).astype(np.float32)
    c = pel.screen_curvature(device, normals, positions, ids=inside.astype(np.uint8))
    assert c.dtype == np.float32 and not c[~inside].any()
    assert np.abs(c[c > 0] * radius - 1).max() < tolerance["screenSphere"]
    assert (c > 0).sum() > 0.95 * inside.sum()
    out = np.zeros((60, 160), np.float32)
    pel.screen_curvature(device, normals, positions, ids=inside, out=out[:, ::2])  # a mask of bool
    assert np.array_equal(out[:, ::2], c) and not out[:, 1::2].any()
    with pytest.raises(pel.PellucidError, match="either"):
        pel.screen_curvature(device, normals)


def test_arrays_outlive_what_a_later_error_left_under_way(moving_device, sphere, monkeypatch):
    live = pel.LiveMesh(pel.MeshTopology(moving_device, sphere.triangles, len(sphere.positions)))
    held = []
    monkeypatch.setattr(_in_flight, "hold", lambda event, *used: (event.wait(), held.append(used)))
    with pytest.raises(pel.PellucidError, match="range 0"):
        live.update(sphere.positions, None, np.empty(len(sphere.positions), np.float32),
                    [(len(sphere.positions), 1)])
    arrays = [view.span.array for views, _ in held for view in views]
    assert any(np.shares_memory(a, sphere.positions)
               for a in arrays), "its copy to the device may still be read"
