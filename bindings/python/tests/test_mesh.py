"""Curvature of meshes, in whatever layout the arrays have."""
import numpy as np
import pytest

import pellucid as pel


def curvature_of(device, mesh, **settings):
    return pel.MeshTopology(device, mesh.triangles, len(mesh.positions)).curvature(mesh.positions, mesh.normals, **settings)


@pytest.mark.parametrize("radius", [0.25, 10.0])
@pytest.mark.parametrize("passes", [0, 2])
def test_sphere_has_the_curvature_of_a_sphere(device, make_sphere, tolerance, radius, passes):
    # Exact normals are positions over the radius, so that every edge gives exactly 1 / r.
    c = curvature_of(device, make_sphere(radius), estimator="edge", smoothing_passes=passes)
    assert c.dtype == np.float32
    assert np.abs(c * radius - 1).max() < tolerance["edgeCurvature"]


def test_scale_and_params(device, sphere):
    plain = curvature_of(device, sphere)
    params = pel.CurvatureParams(scale=3, smoothing_passes=2)
    assert np.array_equal(curvature_of(device, sphere, params=params), curvature_of(device, sphere, scale=3))
    assert np.allclose(curvature_of(device, sphere, scale=3), 3 * plain, rtol=1e-6)
    assert params.scale == 3


def test_smoothing_to_a_radius_by_either_weights(device, make_sphere):
    mesh = make_sphere(5.0)
    rough = curvature_of(device, mesh, smoothing_passes=0)
    spread = {}
    for weights in ("cotangent", "area"):
        params = pel.CurvatureParams(smoothing_passes=0, smoothing_radius=1.0, smoothing_weights=weights)
        assert params.smoothing_weights == pel.SmoothingWeights[weights.upper()]
        spread[weights] = curvature_of(device, mesh, params=params)
        assert np.ptp(spread[weights]) < np.ptp(rough)
        by_keywords = curvature_of(device, mesh, smoothing_passes=0, smoothing_radius=1.0, smoothing_weights=weights)
        assert np.array_equal(by_keywords, spread[weights])
    assert not np.array_equal(spread["cotangent"], spread["area"])
    with pytest.raises(ValueError, match="cotangent, area"):
        pel.CurvatureParams(smoothing_weights="length")


def test_quantities_have_their_shapes(device, make_sphere):
    mesh = make_sphere(5.0)
    frame = curvature_of(device, mesh, estimator="tensor", quantity="frame")
    assert frame.shape == (len(mesh.positions), 8)
    principal = curvature_of(device, mesh, estimator="tensor", quantity=pel.CurvatureQuantity.PRINCIPAL)
    assert np.array_equal(principal, frame[:, :2]) and np.abs(principal * 5 - 1).max() < 1e-2
    assert np.abs(np.linalg.norm(frame[1:-1, 2:5], axis=1) - 1).max() < 1e-5
    with pytest.raises(ValueError, match="shape .*8"):
        curvature_of(device, mesh, estimator="tensor", quantity="frame", out=np.empty(len(mesh.positions), np.float32))


def interleaved(mesh):
    vertex = np.zeros(len(mesh.positions), [("p", "f4", 3), ("pad", "f4"), ("n", "f4", 3), ("c", "f4"), ("uv", "f4", 2)])
    vertex["p"], vertex["n"], vertex["c"] = mesh.positions, mesh.normals, -1
    return vertex


@pytest.mark.parametrize("moving", [False, True])
def test_any_stride_gives_the_same_bits(device, moving_device, sphere, moving):
    d = moving_device if moving else device
    expected = curvature_of(device, sphere)
    vertex = interleaved(sphere)
    before = vertex.copy()
    topology = pel.MeshTopology(d, sphere.triangles, positions=vertex["p"])
    result = topology.curvature(vertex["p"], vertex["n"], out=vertex["c"])
    assert result.base is vertex or np.shares_memory(result, vertex)
    assert np.array_equal(vertex["c"], expected)
    for field in ("p", "pad", "n", "uv"):
        assert np.array_equal(vertex[field], before[field]), field
    every_second = np.zeros((len(expected), 2), np.float32)
    topology.curvature(np.repeat(sphere.positions, 2, 0)[::2], sphere.normals, out=every_second[:, 1])
    assert np.array_equal(every_second[:, 1], expected) and not every_second[:, 0].any()


def test_nothing_is_copied_on_a_cpu(device, sphere):
    if device.info.type != pel.DeviceType.CPU:
        pytest.skip("the default device has memory of its own")
    topology = pel.MeshTopology(device, sphere.triangles, len(sphere.positions))
    before = device.stats()
    topology.submit_curvature(sphere.positions, sphere.normals, np.empty(len(sphere.positions), np.float32)).wait()
    after = device.stats()
    assert after.launches > before.launches
    assert (after.bytes_to_device, after.bytes_to_host) == (before.bytes_to_device, before.bytes_to_host)


def test_buffers_and_dlpack(device, sphere):
    expected = curvature_of(device, sphere)
    n = len(expected)
    data = pel.Buffer(device, np.hstack([sphere.positions, sphere.normals]))
    result = pel.Buffer(device, 4 * n)
    topology = pel.MeshTopology(device, sphere.triangles, n)
    topology.submit_curvature(pel.Vertices(data, n, 0, 24), pel.Vertices(data, n, 12, 24), pel.Vertices(result, n)).wait()
    assert np.array_equal(result.read(np.empty(n, np.float32)), expected)

    class Tensor:  # another library's array
        def __init__(self, array):
            self.array = array

        def __dlpack__(self, **how):
            return self.array.__dlpack__(**how)

        def __dlpack_device__(self):
            return self.array.__dlpack_device__()

    assert np.array_equal(topology.curvature(Tensor(sphere.positions), memoryview(sphere.normals)), expected)


@pytest.mark.parametrize("moving", [False, True])
def test_normals_are_made(device, moving_device, sphere, moving):
    topology = pel.MeshTopology(moving_device if moving else device, sphere.triangles, len(sphere.positions))
    vertex = interleaved(sphere)
    made = topology.normals(vertex["p"], out=vertex["n"])
    assert np.shares_memory(made, vertex) and np.array_equal(vertex["p"], sphere.positions)
    # The triangles' own directions by their angles at the vertex, in double precision.
    p = sphere.positions.astype(np.float64)
    sums = np.zeros_like(p)
    for corner in range(3):
        a, b, c = (p[sphere.triangles[:, (corner + k) % 3]] for k in range(3))
        face = np.cross(b - a, c - a)
        cosine = ((b - a) * (c - a)).sum(1) / np.linalg.norm(b - a, axis=1) / np.linalg.norm(c - a, axis=1)
        np.add.at(sums, sphere.triangles[:, corner],
                  face / np.linalg.norm(face, axis=1)[:, None] * np.arccos(np.clip(cosine, -1, 1))[:, None])
    assert np.abs(made - sums / np.linalg.norm(sums, axis=1)[:, None]).max() < 1e-4
    # Curvature without normals is that with these.
    with_made = topology.curvature(sphere.positions, np.ascontiguousarray(made), estimator="tensor")
    assert np.array_equal(topology.curvature(sphere.positions, estimator="tensor"), with_made)


def test_a_topology_is_saved_and_loaded(device, sphere):
    topology = pel.MeshTopology(device, sphere.triangles, len(sphere.positions))
    data = topology.save()
    again = pel.MeshTopology.load(device, data)
    assert again.num_vertices == len(sphere.positions) and again.report.triangles == len(sphere.triangles)
    assert np.array_equal(again.curvature(sphere.positions, sphere.normals), topology.curvature(sphere.positions, sphere.normals))
    with pytest.raises(pel.PellucidError):
        pel.MeshTopology.load(device, data[:-4])


def test_welding_joins_a_seam(device, sphere, tolerance):
    split = sphere.triangles.ravel()
    positions, normals = sphere.positions[split], sphere.normals[split]
    soup = np.arange(len(split), dtype=np.int32).reshape(-1, 3)
    welded = pel.MeshTopology(device, soup, positions=positions, weld="exact")
    assert welded.report.vertices == len(split) and welded.report.unique_positions == len(sphere.positions)
    assert welded.report.border_edges == 0
    whole = curvature_of(device, sphere)[split]
    assert np.abs(welded.curvature(positions, normals) - whole).max() < tolerance["edgeCurvature"] * whole.max()
    assert pel.MeshTopology(device, soup, positions=positions).report.border_edges == len(split)


def test_report_counts_what_was_skipped(device, sphere):
    positions = sphere.positions.copy()
    positions[5, 1] = np.nan
    topology = pel.MeshTopology(device, sphere.triangles, len(positions))
    c = topology.curvature(positions, sphere.normals, report=True)
    assert topology.report.non_finite_positions == 1 and np.isfinite(c).all()


def test_uv_scale(device, tolerance):
    # A flat square of side 40 that its UVs map onto half the unit square.
    positions = np.array([[0, 0, 0], [40, 0, 0], [40, 40, 0], [0, 40, 0]], np.float32)
    uvs = np.ascontiguousarray(positions[:, :2] / 80)
    topology = pel.MeshTopology(device, [[0, 1, 2], [0, 2, 3]], 4)
    assert topology.uv_scale(positions, uvs) == pytest.approx(80, rel=tolerance["uvScale"])
    with pytest.raises(pel.PellucidError):
        topology.uv_scale(positions, np.zeros_like(uvs))


@pytest.mark.parametrize("change, message", [
    (lambda m: dict(positions=m.positions.astype(np.float64)), "positions is float64; float32 is needed"),
    (lambda m: dict(positions=m.positions[:, :2]), r"positions has the shape \(1106, 2\); \(n, 3\) is needed"),
    (lambda m: dict(positions=m.positions[::-1]), "positions has a negative stride"),
    (lambda m: dict(normals=np.broadcast_to(np.float32([0, 0, 1]), m.positions.shape)), "normals is broadcast"),
    (lambda m: dict(normals=m.normals.astype(">f4")), "normals is >f4; float32 is needed"),
    (lambda m: dict(normals=m.normals.tolist()), "normals is a list"),
    (lambda m: dict(out=np.zeros(5, np.float32)), "out is float32 of shape"),
    (lambda m: dict(estimator="magic"), "estimator is 'magic'; it must be one of edge"),
])
def test_arrays_that_do_not_fit_are_named(device, sphere, change, message):
    given = dict(positions=sphere.positions, normals=sphere.normals) | change(sphere)
    topology = pel.MeshTopology(device, sphere.triangles, len(sphere.positions))
    with pytest.raises((ValueError, TypeError), match=message):
        topology.curvature(given.pop("positions"), given.pop("normals"), **given)


def test_read_only_results_are_refused(device, sphere):
    out = np.zeros(len(sphere.positions), np.float32)
    out.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        curvature_of(device, sphere, out=out)


@pytest.mark.parametrize("indices, error", [
    ([[0, 1, 9]], pel.PellucidError), ([0, 1], pel.PellucidError), ([[0, 1, -1]], ValueError), ([[0.0, 1, 2]], ValueError)])
def test_bad_indices(device, indices, error):
    with pytest.raises(error):
        pel.MeshTopology(device, indices, 3)


def test_orient_mesh_turns_what_disagrees(device, make_sphere):
    mesh = make_sphere(2.0)
    turned = mesh.triangles.copy()
    wrong = np.random.default_rng(3).random(len(turned)) < 0.5
    turned[wrong] = turned[wrong][:, [0, 2, 1]]
    topology = pel.MeshTopology(device, turned, len(mesh.positions), weld="exact", positions=mesh.positions)
    assert topology.report.inconsistent_edges > 0
    for normals in (None, mesh.normals):
        oriented, found = pel.orient_mesh(turned, positions=mesh.positions, normals=normals, weld="exact")
        assert oriented.dtype == np.uint32 and found.triangles_turned == (oriented != turned).any(1).sum() > 0
        assert found.inconsistent_edges == 0 and found.parts >= found.parts_turned == 1
        faces = mesh.positions[oriented]
        outward = np.einsum("ij,ij->i", np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]), faces.mean(1))
        assert (outward >= 0).all()
        report = pel.MeshTopology(device, oriented, weld="exact", positions=mesh.positions).report
        assert report.inconsistent_edges == 0
    flat, _ = pel.orient_mesh(turned.ravel(), len(mesh.positions))
    assert flat.shape == turned.ravel().shape
    with pytest.raises(ValueError, match="normals has 3 rows"):
        pel.orient_mesh(turned, positions=mesh.positions, normals=mesh.normals[:3])
    with pytest.raises(pel.PellucidError, match="together with PelMeshTopologyDesc.positions"):
        pel.orient_mesh(turned, len(mesh.positions), normals=mesh.normals)
