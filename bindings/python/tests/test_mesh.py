"""Curvature of meshes, in whatever layout the arrays have, of meshes that move in part, and of pictures."""
import numpy as np
import pytest

import pellucid as pel
from pellucid import _in_flight


def curvature_of(device, mesh, **settings):
    return pel.MeshTopology(
        device, mesh.triangles, len(mesh.positions)).curvature(mesh.positions, mesh.normals, **settings)


def test_settings_and_quantities(device, sphere):
    params = pel.CurvatureParams(scale=3, smoothing_passes=2)
    by_params = curvature_of(device, sphere, params=params)
    assert np.array_equal(by_params, curvature_of(device, sphere, scale=3)) and params.scale == 3
    assert np.allclose(by_params, 3 * curvature_of(device, sphere), rtol=1e-6)
    frame = curvature_of(device, sphere, estimator="tensor", quantity="frame")
    assert frame.shape == (len(sphere.positions), 8)
    principal = curvature_of(device, sphere, estimator="tensor", quantity=pel.CurvatureQuantity.PRINCIPAL)
    assert np.array_equal(principal, frame[:, :2]) and np.abs(principal * 10 - 1).max() < 1e-2


def interleaved(mesh):
    vertex = np.zeros(len(mesh.positions),
                      [("p", "f4", 3), ("pad", "f4"), ("n", "f4", 3), ("c", "f4"), ("uv", "f4", 2)])
    vertex["p"], vertex["n"], vertex["c"] = mesh.positions, mesh.normals, -1
    return vertex


@pytest.mark.parametrize("moving", [False, True])
def test_any_stride_gives_the_same_bits(device, moving_device, sphere, moving):
    d = moving_device if moving else device
    expected = curvature_of(device, sphere)
    vertex = interleaved(sphere)
    known = vertex.copy()
    topology = pel.MeshTopology(d, sphere.triangles, positions=vertex["p"])
    before = d.stats()
    result = topology.curvature(vertex["p"], vertex["n"], out=vertex["c"])
    if not moving and d.info.type == pel.DeviceType.CPU:  # where nothing is copied
        after = d.stats()
        assert after.launches > before.launches and after.bytes_to_host == before.bytes_to_host
        assert after.bytes_to_device == before.bytes_to_device
    assert np.shares_memory(result, vertex)
    known["c"] = expected
    assert vertex.tobytes() == known.tobytes()
    every_second = np.zeros((len(expected), 2), np.float32)
    topology.curvature(np.repeat(sphere.positions, 2, 0)[::2], sphere.normals, out=every_second[:, 1])
    assert np.array_equal(every_second[:, 1], expected) and not every_second[:, 0].any()
    made = topology.normals(vertex["p"], out=vertex["n"])
    assert np.shares_memory(made, vertex) and np.array_equal(vertex["p"], sphere.positions)
    assert np.abs(made - sphere.normals).max() < 0.01
    # Curvature without normals is that with these.
    with_made = topology.curvature(sphere.positions, np.ascontiguousarray(made), estimator="tensor")
    assert np.array_equal(topology.curvature(sphere.positions, estimator="tensor"), with_made)


def test_buffers_and_dlpack(device, sphere):
    expected = curvature_of(device, sphere)
    n = len(expected)
    data = pel.Buffer(device, np.hstack([sphere.positions, sphere.normals]))
    result = pel.Buffer(device, 4 * n)
    topology = pel.MeshTopology(device, sphere.triangles, n)
    topology.submit_curvature(pel.Vertices(data, n, 0, 24), pel.Vertices(data, n, 12, 24),
                              pel.Vertices(result, n)).wait()
    assert np.array_equal(result.read(np.empty(n, np.float32)), expected)

    class Tensor:  # another library's array
        def __init__(self, array):
            self.array = array

        def __dlpack__(self, **how):
            return self.array.__dlpack__(**how)

        def __dlpack_device__(self):
            return self.array.__dlpack_device__()

    assert np.array_equal(topology.curvature(Tensor(sphere.positions), memoryview(sphere.normals)), expected)


def test_a_topology_is_saved_and_loaded(device, sphere):
    topology = pel.MeshTopology(device, sphere.triangles, len(sphere.positions))
    data = topology.save()
    again = pel.MeshTopology.load(device, data)
    assert again.num_vertices == len(sphere.positions) and again.report.triangles == len(sphere.triangles)
    assert np.array_equal(again.curvature(sphere.positions, sphere.normals),
                          topology.curvature(sphere.positions, sphere.normals))
    with pytest.raises(pel.PellucidError):
        pel.MeshTopology.load(device, data[:-4])


@pytest.mark.parametrize("change, message", [
    (lambda m: dict(positions=m.positions.astype(np.float64)), "positions is float64; float32 is needed"),
    (lambda m: dict(positions=m.positions[:, :2]),
     r"positions has the shape \(1106, 2\); \(n, 3\) is needed"),
    (lambda m: dict(positions=m.positions[::-1]), "positions has a negative stride"),
    (lambda m: dict(normals=np.broadcast_to(np.float32([0, 0, 1]), m.positions.shape)),
     "normals is broadcast"),
    (lambda m: dict(normals=m.normals.astype(">f4")), "normals is >f4; float32 is needed"),
    (lambda m: dict(normals=m.normals.tolist()), "normals is a list"),
    (lambda m: dict(out=np.zeros(5, np.float32)), "out is float32 of shape"),
    (lambda m: dict(out=np.zeros(len(m.positions), np.float32), quantity="frame"), "shape .*8"),
    (lambda m: dict(out=np.broadcast_to(np.float32(0), len(m.positions))), "out is (broadcast|read-only)"),
    (lambda m: dict(estimator="magic"), "estimator is 'magic'; it must be one of edge"),
])
def test_arrays_that_do_not_fit_are_named(device, sphere, change, message):
    given = dict(positions=sphere.positions, normals=sphere.normals) | change(sphere)
    topology = pel.MeshTopology(device, sphere.triangles, len(sphere.positions))
    with pytest.raises((ValueError, TypeError), match=message):
        topology.curvature(given.pop("positions"), given.pop("normals"), **given)


@pytest.mark.parametrize("indices, count, error, message", [
    ([[0, 1, 9]], 3, pel.PellucidError, "vertex 9"), ([0, 1], 3, pel.PellucidError, "2 are left over"),
    ([[0, 1, -1]], 3, ValueError, "from -1 to 1"), ([[0.0, 1, 2]], 3, ValueError, "indices are float64"),
    ([[0, 1, 2]], None, ValueError, "num_vertices or positions"),
    ([[0, 1, 2]], 2**32, ValueError, "num_vertices is 4294967296"),
    ([[0, 1, 2]], -1, ValueError, "num_vertices is -1")])
def test_bad_indices(device, indices, count, error, message):
    with pytest.raises(error, match=message):
        pel.MeshTopology(device, indices, count)


def test_orient_mesh_turns_what_disagrees(device, sphere):
    turned = sphere.triangles.copy()
    turned[::2] = turned[::2][:, [0, 2, 1]]
    oriented, found = pel.orient_mesh(turned, positions=sphere.positions, normals=sphere.normals,
                                      weld="exact")
    assert np.array_equal(oriented, sphere.triangles) and oriented.dtype == np.uint32
    assert found.triangles_turned == len(turned[::2]) and found.inconsistent_edges == 0
    flat, _ = pel.orient_mesh(turned.ravel(), len(sphere.positions))
    assert flat.shape == turned.ravel().shape
    with pytest.raises(ValueError, match="normals has 3 rows"):
        pel.orient_mesh(turned, positions=sphere.positions, normals=sphere.normals[:3])
    with pytest.raises(pel.PellucidError, match="only with PelMeshTopologyDesc.positions"):
        pel.orient_mesh(turned, len(sphere.positions), normals=sphere.normals)


def test_reports_and_uv_scale(device, sphere, tolerance):
    positions = sphere.positions.copy()
    positions[5, 1] = np.nan
    topology = pel.MeshTopology(device, sphere.triangles, len(positions))
    c = topology.curvature(positions, sphere.normals, report=True)
    assert topology.report.non_finite_positions == 1 and np.isfinite(c).all()
    # A flat square of side 40 that its UVs map onto half the unit square.
    square = np.array([[0, 0, 0], [40, 0, 0], [40, 40, 0], [0, 40, 0]], np.float32)
    uvs = np.ascontiguousarray(square[:, :2] / 80)
    topology = pel.MeshTopology(device, [[0, 1, 2], [0, 2, 3]], 4)
    assert topology.uv_scale(square, uvs) == pytest.approx(80, rel=tolerance["uvScale"])


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
    for wrong in (len(positions), 1), (-1, 2), (2**32, 1), (0, 2**32 + 1):
        with pytest.raises(pel.PellucidError, match="range 0"):
            live.update(positions, normals, out, [wrong])
    both = pel.CurvatureParams(quantity="principal")
    pairs = np.empty((len(positions), 2), np.float32)
    pel.LiveMesh(topology, both).update(positions, normals, pairs)
    assert np.array_equal(pairs, topology.curvature(positions, normals, params=both))


def test_screen_curvature(device, view):
    c = pel.screen_curvature(device, view.normal, view.position, ids=view.material)
    assert c.dtype == np.float32 and not c[~view.inside].any() and np.median(c[c > 0]) == pytest.approx(0.1)
    out, upper = np.zeros((len(c), 2 * c.shape[1]), np.float32), view.inside.copy()  # of bool
    upper[len(c) // 2:] = False
    pel.screen_curvature(device, view.normal, view.position, ids=upper, out=out[:, ::2])
    assert not out[:, 1::2].any() and not out[:, ::2][~upper].any()
    assert np.array_equal(out[:len(c) // 2 - 4, ::2], c[:len(c) // 2 - 4])
    with pytest.raises(pel.PellucidError, match="either"):
        pel.screen_curvature(device, view.normal)


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
