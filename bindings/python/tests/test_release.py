"""Letting go of objects whose device has work: others must get on, for that work may wait for them."""
import subprocess
import sys
import textwrap
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import pellucid as pel
from pellucid import _in_flight

# The last reference to a device waits for its queue. Here the queue waits for an event that another Python
# thread sets, which it can only with the GIL.
GATED = textwrap.dedent("""
    import gc, threading, time
    import numpy as np
    import pyopencl as cl
    import pellucid as pel

    wanted = pel.Device().info.name
    context = cl.Context([d for p in cl.get_platforms() for d in p.get_devices() if d.name == wanted][:1])
    triangle = np.arange(3, dtype=np.uint32)

    makers = {
        "Device": lambda d: d, "Buffer": lambda d: pel.Buffer(d, 16),
        "Event": lambda d: pel.Buffer(d, 16).submit_read(np.empty(16, np.uint8)),
        "MeshTopology": lambda d: pel.MeshTopology(d, triangle, 3),
        "LiveMesh": lambda d: pel.LiveMesh(pel.MeshTopology(d, triangle, 3)),
        "Lut": lambda d: pel.Lut.specular(d, width=8, height=8), "Shader": pel.Shader}
    for kind, make in makers.items():
        queue = cl.CommandQueue(context)
        device = pel.Device.from_cl(queue)
        last = make(device)._handle
        device.finish()  # forgets what was in flight
        gate = cl.UserEvent(context)
        cl.enqueue_barrier(queue, wait_for=[gate])
        del device
        gc.collect()
        def open_gate():
            time.sleep(0.05)
            gate.set_status(cl.command_execution_status.COMPLETE)
        thread = threading.Thread(target=open_gate)
        thread.start()
        del last
        thread.join()
        print(kind, flush=True)
""")


def test_the_gil_is_free_while_a_device_goes(tmp_path):
    pytest.importorskip("pyopencl")
    kinds = ["Device", "Buffer", "Event", "MeshTopology", "LiveMesh", "Lut", "Shader"]
    try:
        done = subprocess.run([sys.executable, "-c", GATED], stdout=subprocess.PIPE, text=True, timeout=100)
    except subprocess.TimeoutExpired as stuck:
        pytest.fail(f"stuck after {(stuck.stdout or b'').decode().split()} of {kinds}")
    assert done.returncode == 0 and done.stdout.split() == kinds


def test_everything_dropped_while_work_is_in_flight(make_sphere):
    """From several threads, each with devices of its own, and waiting for nothing."""
    mesh = make_sphere(1.0, 40, 80)

    def submit_and_forget(_):
        for _ in range(6):
            device = pel.Device()
            topology = pel.MeshTopology(device, mesh.triangles, len(mesh.positions))
            for _ in range(3):
                out = np.empty(len(mesh.positions), np.float32)
                topology.submit_curvature(mesh.positions.copy(), mesh.normals, out, estimator="edge",
                                          smoothing_passes=50)
            pel.Buffer(device, 1 << 16).submit_read(np.empty(1 << 16, np.uint8))

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(submit_and_forget, range(4), timeout=120))
    while _in_flight.in_flight():
        pass


def test_work_may_be_submitted_from_finalizers(device):
    """They run anywhere, in the middle of looking which work is done too."""
    class Ends:
        looked = False

        def is_done(self):
            if not self.looked:
                self.looked = True
                pel.Buffer(device, 16).submit_read(np.empty(16, np.uint8)).wait()
            return True

    ends = Ends()
    thread = threading.Thread(target=_in_flight.hold, args=(ends, np.empty(1)), daemon=True)
    thread.start()
    thread.join(60)
    if thread.is_alive():
        _in_flight._flying.clear()
        pytest.fail("stuck")
    _in_flight.sweep()
    assert ends.looked and _in_flight.in_flight() == 0


def test_two_threads_warm_up_the_same_shaders(device):
    """In opposite order; each keeps both from other threads meanwhile."""
    image = np.zeros((2, 16, 3), np.float32)
    shaders = [pel.Shader(device) for _ in range(2)]
    for shader in shaders:
        shader.set_image("radiance", np.empty_like(image)).set_image("normal_shading", image)
        shader.set_material(1, pel.Material()).set_ambient(pel.Ambient(constant=(1, 1, 1)))
    pel.warm_up_programs(device, shaders=shaders)

    def warm_up(order):
        for _ in range(25):
            pel.warm_up_programs(device, shaders=order)

    threads = [threading.Thread(target=warm_up, args=(order,), daemon=True)
               for order in (shaders, shaders[::-1])]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(100)
    assert not any(thread.is_alive() for thread in threads), "each waits for the other"


AT_WORK = textwrap.dedent("""
    import sys, threading, time
    import numpy as np
    import pellucid as pel
    device = pel.Device()
    if sys.argv[1] == "progress":
        device.set_progress(lambda fraction, what: True)
    grid = np.arange(1 << 14, dtype=np.uint32).reshape(128, 128)
    triangles = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[:-1, 1:]], -1).ravel()
    positions = np.random.default_rng(1).normal(size=(grid.size, 3)).astype(np.float32)

    def work():
        while True:
            pel.MeshTopology(device, triangles, positions=positions, weld="exact")

    for _ in range(3):
        threading.Thread(target=work, daemon=True).start()
    time.sleep(0.2)
""")


@pytest.mark.parametrize("progress", ["progress", "none"])
def test_the_process_ends_while_daemon_threads_are_at_work(progress):
    done = subprocess.run([sys.executable, "-c", AT_WORK, progress], stderr=subprocess.PIPE, text=True,
                          timeout=100)
    assert (done.returncode, done.stderr) == (0, "")
