"""The GIL, Ctrl-C, progress callbacks, and memory that outlives the name it had."""
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import types

import numpy as np
import pytest

import pellucid as pel
from pellucid.device import progress_bar


def test_other_threads_run_during_work(device, make_sphere):
    mesh = make_sphere(1.0, 300, 600)
    topology = pel.MeshTopology(device, mesh.triangles, len(mesh.positions))
    topology.curvature(mesh.positions, mesh.normals)
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.0005)

    thread = threading.Thread(target=tick)
    thread.start()
    inside, patience = 0, time.perf_counter() + 60
    while inside < 20 and time.perf_counter() < patience:
        start = time.perf_counter()
        topology.curvature(mesh.positions, mesh.normals, smoothing_passes=60)
        end = time.perf_counter()
        inside += max(0, sum(start < t < end for t in ticks) - 1)  # one may have begun before the call
        ticks.clear()
    stop.set()
    thread.join()
    assert inside >= 20


@pytest.fixture(scope="module")
def work(make_sphere):
    """A device, and a call that reports its progress."""
    mesh, device = make_sphere(1.0, 600, 900), pel.Device()
    return device, lambda: pel.MeshTopology(device, mesh.triangles, positions=mesh.positions, weld="exact")


def raising(fraction, what):
    raise KeyError("mine")


@pytest.mark.parametrize("callback, error, message", [
    (lambda fraction, what: False, pel.PellucidError, None), (raising, KeyError, "mine"),
    (lambda fraction, what: {}, TypeError, "returns True, False or None")])
def test_progress_is_reported_and_cancels(work, callback, error, message):
    device, run = work
    seen = []
    device.set_progress(lambda fraction, what: seen.append((fraction, what)))
    run()
    assert len(seen) >= 2 and all(0 <= fraction <= 1 and what for fraction, what in seen)
    device.set_progress(callback)
    with pytest.raises(error, match=message) as caught:
        run()
    assert error is not pel.PellucidError or caught.value.code is pel.ErrorCode.CANCELLED
    device.set_progress(None)
    run()


@pytest.mark.parametrize("installed", [True, False])
def test_progress_is_lines_without_tqdm_or_a_terminal(work, capsys, monkeypatch, installed):
    device, run = work
    if not installed:
        monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    device.set_progress(True)
    run()
    device.set_progress(None)
    said = capsys.readouterr().err
    assert "%" in said and "\r" not in said
    show = progress_bar()
    for step in (*range(17), 8):  # a line for each tenth or more, and for what is done again
        show(step / 16, "work")
    lines = capsys.readouterr().err.splitlines()
    assert lines == [f"work: {step / 16:.0%}" for step in (*range(0, 17, 2), 8)]


def test_progress_bar_ends_with_its_work(monkeypatch):
    """A piece of work that is done again begins a bar of its own."""
    bars = []

    class Bar:
        def __init__(self, **_):
            self.n, self.closed = 0.0, 0
            bars.append(self)

        def update(self, more):
            self.n += more

        def close(self):
            self.closed += 1

    monkeypatch.setitem(sys.modules, "tqdm.auto", types.SimpleNamespace(tqdm=Bar))
    monkeypatch.setitem(sys.modules, "ipykernel", None)  # where a bar is shown without a terminal
    show = progress_bar()
    for again in (1, 2):
        for fraction in (0.0, 0.25, 0.5, 1.0):
            show(fraction, "work")
            show(fraction / 2, "other work")
            assert bars[-1 if again == 2 else 0].n == fraction
    assert [(bar.n, bar.closed) for bar in bars] == [(1.0, 1), (0.5, 0), (1.0, 1)]


def at_once():
    """Seconds until Ctrl-C is noticed: longer under sanitizers, on slow machines and busy ones."""
    start = time.monotonic()
    sum(range(10_000_000))  # a fifth of a second or so
    share = max(2.0, 8 * (time.monotonic() - start), 4 * os.getloadavg()[0] / (os.cpu_count() or 1))
    return share * (10 if os.environ.get("PELLUCID_SANITIZE") else 1)


EVERY_CALL = textwrap.dedent("""
    import signal, time
    import numpy as np
    import pellucid as pel
    n = 350
    grid = np.arange(n * n, dtype=np.uint32).reshape(n, n)
    low, right, up, both = grid[:-1, :-1], grid[1:, :-1], grid[:-1, 1:], grid[1:, 1:]
    quads = np.stack([low, right, up, up, right, both], -1).ravel()
    y, x = np.mgrid[:n, :n].astype(np.float32)
    points = np.stack([x, y, 20 * np.sin(x / 50)], -1).reshape(-1, 3)
    device = pel.Device()
    topology = pel.MeshTopology(device, quads, len(points))
    expected = topology.curvature(points)
    uvs, saved = np.ascontiguousarray(points[:, :2]), topology.save()
    distances = np.linspace(0.01, 9, 1000000)
    burley = pel.Profile.burley((1, 2, 3), (0.8, 0.8, 0.8))
    table = pel.Lut.curvature(device, width=512, height=512)
    image = np.ones((512, 512, 3), np.float32)
    shader = pel.Shader(device).set_image("radiance", image.copy()).set_image("normal_shading", image)
    shader.set_material(1, pel.Material()).set_lights([pel.Light()] * 32).commit()

    def finish():
        topology.submit_curvature(points, None, np.empty(len(points), np.float32), smoothing_passes=400)
        device.finish()

    work = {
        "weld": lambda: pel.MeshTopology(device, quads, positions=points, weld="tolerance",
                                         weld_tolerance=1e-3),
        "save": topology.save, "load": lambda: pel.MeshTopology.load(device, saved),
        "curvature": lambda: topology.curvature(points.copy(), smoothing_passes=400),
        "submit": lambda: topology.submit_curvature(points.copy(), None, np.empty(len(points), np.float32)),
        "report": lambda: topology.curvature(points.copy(), report=True, smoothing_passes=20),
        "uv_scale": lambda: topology.uv_scale(points.copy(), uvs.copy()),
        "table": lambda: pel.Lut.curvature(device, width=512, height=512, form="sphere", profile=burley),
        "read": lambda: table.read("faceworks8"),
        "evaluate": lambda: burley.evaluate(distances),
        "shade": shader.execute, "screen": lambda: pel.screen_curvature(device, image.copy(), image.copy()),
        "buffer": lambda: pel.Buffer(device, np.zeros(1 << 26, np.uint8)), "finish": finish,
        "colours": lambda: pel.skin_from_albedo(np.random.default_rng(1).random((1 << 17, 3), np.float32)),
    }

    class Alarm(Exception):
        pass

    def ring(*_):
        raise Alarm

    signal.signal(signal.SIGALRM, ring)
    for name, call in work.items():
        start = time.monotonic()
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        try:
            while True:
                call()
        except Alarm:
            print(name, time.monotonic() - start - 0.1, flush=True)
    print("same", float(np.array_equal(topology.curvature(points), expected)), flush=True)
""")


def test_ctrl_c_reaches_every_long_call():
    # Whatever a call works on outlives it: what was left behind writes to nothing that was freed.
    child = subprocess.run([sys.executable, "-c", EVERY_CALL], stdout=subprocess.PIPE, text=True, timeout=300)
    assert child.returncode == 0
    seen = {name: float(value) for name, value in (line.split() for line in child.stdout.splitlines())}
    assert seen.pop("same") == 1 and len(seen) == 15
    limit = at_once()
    assert not {name: seconds for name, seconds in seen.items() if seconds > limit}


COMPILE = textwrap.dedent("""
    import time
    import numpy as np
    import pellucid as pel
    device = pel.Device()
    image = np.ones((8, 8, 3), np.float32)
    shader = pel.Shader(device).set_image("radiance", np.empty_like(image)).set_image("normal_shading", image)
    shader.set_image("position", image).set_camera(pel.Camera()).set_ambient(pel.Ambient(constant=(1, 1, 1)))
    lut = pel.Lut.curvature(device, width=8, height=8)
    shader.set_material(1, pel.Material(specular=1, deep_scatter_color=(1, 1, 1), thickness_taps=32), lut)
    shader.set_lights([pel.Light(shadow_filter_texels=48, shadow_depth_range=1)])
    shader.set_light_image(0, "shadow_map", image[..., 0]).set_image("curvature", image[..., 1])
    try:
        print("go", flush=True)
        shader.commit()
    except KeyboardInterrupt:
        print(time.time(), flush=True)
    start = time.time()
    shader.commit()  # waits for the compiler that was left alone
    print(time.time() - start, flush=True)
""")


def test_ctrl_c_while_a_compiler_works(tmp_path):
    fresh = {**os.environ, "POCL_CACHE_DIR": str(tmp_path), "CUDA_CACHE_DISABLE": "1",
             "NEO_CACHE_PERSISTENT": "0"}
    child = subprocess.Popen([sys.executable, "-c", COMPILE], stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL, text=True, env=fresh)
    try:
        assert child.stdout.readline() == "go\n"
        time.sleep(0.1)
        sent = time.time()
        child.send_signal(signal.SIGINT)
        assert float(child.stdout.readline()) - sent < at_once()
        assert float(child.stdout.readline()) > 0.01, "the compiler had finished before Ctrl-C was noticed"
        assert child.wait(300) == 0
    finally:
        child.kill()
        child.wait()


FORK = textwrap.dedent("""
    import os
    import numpy as np
    import pellucid as pel
    device = pel.Device()
    buffer, shader, profile = pel.Buffer(device, 64), pel.Shader(device), pel.Profile.skin()
    mesh = pel.MeshTopology(device, np.arange(3), 3)
    live, lut = pel.LiveMesh(mesh), pel.Lut.specular(device, width=8, height=8)
    event = buffer.submit_read(np.empty(64, np.uint8))
    if os.fork() == 0:
        uses = (pel.Device, pel.devices, device.finish, lambda: pel.Buffer(device, 64),
                lambda: buffer.read(np.empty(64, np.uint8)),
                shader.commit, lambda: profile.info, mesh.save, live.stats, lut.read, event.wait,
                lambda: pel.orient_mesh(np.arange(3), 3))
        for use in uses:
            try:
                use()
            except pel.PellucidError as error:
                print(error.code.name, "spawn" in str(error), flush=True)
        del live, mesh, lut, event, shader, buffer, profile, device  # nothing waits there
        raise SystemExit(3)
    print(os.waitstatus_to_exitcode(os.wait()[1]))
    device.finish()
    event.wait()
    print(len(mesh.save()) > 0)
""")


def test_calls_in_a_forked_process_raise():
    done = subprocess.run([sys.executable, "-c", FORK], stdout=subprocess.PIPE, text=True, timeout=300)
    assert done.returncode == 0
    assert done.stdout.split("\n")[:14] == ["INVALID_STATE True"] * 12 + ["3", "True"]


def test_events_are_awaited(device):
    import asyncio

    async def both():
        values = np.arange(1 << 20)
        buffer, out = pel.Buffer(device, values), np.empty(1 << 20, values.dtype)
        await asyncio.gather(buffer.submit_read(out), asyncio.sleep(0))
        return np.array_equal(out, values)

    assert asyncio.run(both())
