"""Contexts, queues, buffers and events that PyOpenCL made."""
import functools
import gc
import signal
import threading
import weakref

import numpy as np
import pytest

import pellucid as pel
from pellucid import _in_flight

cl = pytest.importorskip("pyopencl")
cl_array = pytest.importorskip("pyopencl.array")


@pytest.fixture(scope="module")
def queue():
    wanted = pel.Device().info.name
    for platform in cl.get_platforms():
        for device in platform.get_devices():
            if device.name == wanted:
                return cl.CommandQueue(cl.Context([device]))
    pytest.skip("PyOpenCL does not see the device")


def test_curvature_between_buffers(queue, sphere):
    device = pel.Device.from_cl(queue)
    assert device.cl == (queue.context.int_ptr, queue.device.int_ptr, queue.int_ptr)
    n = len(sphere.positions)
    topology = pel.MeshTopology(device, sphere.triangles, n)
    positions = cl_array.to_device(queue, sphere.positions)
    expected = topology.curvature(sphere.positions, sphere.normals)
    mem = cl.Buffer(queue.context, cl.mem_flags.READ_WRITE, 8 * n)
    host = np.empty(2 * n, np.float32)
    columns = cl_array.Array(queue, (n, 2), np.float32, data=mem)
    for out, result in [(pel.Vertices(pel.Buffer.from_cl(device, mem), n), host[:n]),
                        (columns[:, 1], host[1::2])]:
        topology.submit_curvature(positions, sphere.normals, out).wait()
        cl.enqueue_copy(queue, host, mem)
        assert np.array_equal(result, expected)
    other = cl.Buffer(cl.Context([queue.device]), cl.mem_flags.READ_WRITE, 64)
    with pytest.raises(pel.PellucidError, match="another cl_context"):
        pel.Buffer.from_cl(device, other)


def test_events_both_ways(queue):
    device = pel.Device.from_cl(queue)
    gate = cl.UserEvent(queue.context)
    buffer, out = pel.Buffer(device, np.int64([5])), np.zeros(1, np.int64)
    event = buffer.submit_read(out, waits=[pel.Event.from_cl(device, gate)])
    assert not event.done
    gate.set_status(cl.command_execution_status.COMPLETE)
    cl.wait_for_events([cl.Event.from_int_ptr(event.cl)])
    assert event.done and out[0] == 5


@pytest.mark.parametrize("waits_for", ["event", "device"])
@pytest.mark.parametrize("kind", ["buffer read", "buffer write", "table read", "curvature", "shader"])
def test_what_waiting_work_uses_is_kept_until_it_is_done(queue, sphere, kind, waits_for):
    device = pel.Device.from_cl(queue)
    n = len(sphere.positions)
    buffer, table = pel.Buffer(device, np.zeros(64, np.float32)), pel.Lut.shadow(device, width=8, height=8)
    topology = pel.MeshTopology(device, sphere.triangles, n)

    def shade(array, waits):
        shader = pel.Shader(device).set_image("radiance", array).set_image("normal_shading", array.copy())
        return shader.set_material(1, pel.Material()).set_lights(pel.Light()).commit().submit(waits)

    submit = {"buffer read": buffer.submit_read, "buffer write": buffer.submit_write,
              "table read": functools.partial(table.submit_read, "float"), "shader": shade,
              "curvature": functools.partial(topology.submit_curvature, sphere.positions, sphere.normals)}
    device.finish()
    gate = cl.UserEvent(queue.context)
    waits = [pel.Event.from_cl(device, gate)]
    shape = {"table read": (8, 8, 3), "curvature": n, "shader": (8, 8, 3)}.get(kind, 64)
    array = np.full(shape, 7, np.float32)
    gone = []
    weakref.finalize(array, gone.append, kind)
    event = submit[kind](array, waits=waits)
    del array
    gc.collect()
    assert not gone and not event.done
    gate.set_status(cl.command_execution_status.COMPLETE)
    event.wait() if waits_for == "event" else device.finish()
    del event
    gc.collect()
    assert gone and _in_flight.in_flight() == 0, "and no longer"


def test_a_signal_ends_the_wait_of_a_mapping(queue):
    class Alarm(Exception):
        pass

    def ring(*_):
        raise Alarm

    device = pel.Device.from_cl(queue)
    buffer, gate = pel.Buffer(device, 64), cl.UserEvent(queue.context)
    cl.enqueue_barrier(queue, wait_for=[gate])
    late = threading.Timer(20, gate.set_status, [cl.command_execution_status.COMPLETE])
    late.start()
    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, 0.1)
    try:
        with pytest.raises(Alarm), buffer.mapped():
            pass
        assert late.is_alive(), "work that the mapping waits for had ended"
    finally:
        signal.signal(signal.SIGALRM, before)
        late.cancel()
        gate.set_status(cl.command_execution_status.COMPLETE)
        device.finish()


def test_nothing_of_the_hosts_is_kept(queue, sphere):
    """Whatever is made on the host's queue lets go of it again."""
    def work():
        device = pel.Device.from_cl(queue)
        topology = pel.MeshTopology(device, sphere.triangles, positions=sphere.positions, weld="exact")
        out = np.empty(len(sphere.positions), np.float32)
        topology.submit_curvature(sphere.positions, sphere.normals, out)
        pel.LiveMesh(topology).update(sphere.positions, sphere.normals, np.empty_like(out))
        image = np.ones((4, 16, 3), np.float32)
        shader = pel.Shader(device).set_image("radiance", np.empty_like(image))
        shader.set_image("normal_shading", image).set_image("curvature", image[..., 0])
        shader.set_material(1, pel.Material(), pel.Lut.curvature(device, width=8, height=8))
        shader.set_ambient(pel.Ambient(constant=(1, 1, 1))).commit().submit()
        shader.execute()
        with pytest.raises(pel.PellucidError):
            pel.Buffer.from_cl(device, cl.Buffer(cl.Context([queue.device]), cl.mem_flags.READ_WRITE, 64))
        device.finish()

    counts = []
    for _ in range(3):  # the first time the device may keep something for later times
        work()
        gc.collect()
        queue.finish()
        counts.append((queue.reference_count, queue.context.reference_count))
    assert counts[1] == counts[2]
