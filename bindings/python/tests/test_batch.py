"""Batches on a cluster of real processes, some of which are killed, stopped or lie."""
import contextlib
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import pytest

import pellucid as pel

distributed = pytest.importorskip("distributed", reason="distributed is not installed: pip install pellucid[batch]")
cloudpickle = pytest.importorskip("cloudpickle")
batch = pytest.importorskip("pellucid.batch", reason="the package was built without toml++")

from pellucid.batch.run import _local_client  # noqa: E402

cloudpickle.register_pickle_by_value(sys.modules[__name__])  # workers cannot import a test

RADII = [round(1 + 0.01 * i, 2) for i in range(30)]
GRID = f'[[grid]]\nsize = [8, 12]\nencoding = ["half", "float"]\ndiffusion_radius = {RADII}\n'


@pytest.fixture(scope="module")
def client():
    with _local_client(2, ()) as client:
        client.wait_for_workers(2, timeout=60)
        yield client


@pytest.fixture
def manifest(tmp_path):
    (tmp_path / "m.toml").write_text(GRID)
    return batch.Manifest(tmp_path / "m.toml")


class Slow(distributed.WorkerPlugin):
    """Entries take a while, so that there is time to do something to a worker."""

    name = "slow"

    def setup(self, worker):
        from pellucid.batch import worker as module

        self.make = module.make_entry

        def slowly(*arguments):
            time.sleep(0.02)
            return self.make(*arguments)

        module.make_entry = slowly

    def teardown(self, worker):
        from pellucid.batch import worker as module

        module.make_entry = self.make


@pytest.fixture
def slow_client(client):
    client.register_plugin(Slow())
    yield client
    with contextlib.suppress(OSError):  # a worker may be on its way out
        client.unregister_worker_plugin("slow")


def files_of(folder):
    return {p.name: p.read_bytes() for p in folder.iterdir()}


def expected_files(manifest, device):
    return {e.file: manifest.make(device, i) for i, e in enumerate(manifest.entries)}


def check_complete(summary, manifest, device, folder):
    assert summary.made + summary.kept == summary.entries == len(manifest) and summary.failed == 0
    assert sum(summary.made_by.values()) == summary.made
    files = files_of(folder)
    hidden = {name for name in files if name.startswith(".")}  # of workers that died while writing
    assert {k: v for k, v in files.items() if k not in hidden} == expected_files(manifest, device)


def test_the_same_bytes_as_one_process_and_resumed(client, manifest, device, tmp_path):
    out = tmp_path / "out"
    summary = batch.run(manifest, out, scheduler=client)
    assert (summary.made, summary.kept, summary.retried) == (120, 0, 0)
    assert len(summary.made_by) == 2, "both workers had their share"
    check_complete(summary, manifest, device, out)

    names = sorted(e.file for e in manifest.entries)
    (out / names[0]).unlink()
    whole = (out / names[1]).read_bytes()
    (out / names[1]).write_bytes(whole[:-9])
    (out / names[2]).write_bytes(whole)  # another entry's
    again = batch.run(manifest.path, out, scheduler=client)
    assert (again.made, again.redone, again.kept) == (3, 2, 117)
    check_complete(again, manifest, device, out)

    command = os.environ.get("PELLUCID_COMMAND")
    if not command:
        pytest.skip("PELLUCID_COMMAND does not name the built command")
    report = subprocess.run([command, "batch", manifest.path, "-o", out, "--json"], check=True, capture_output=True)
    assert json.loads(report.stdout)["kept"] == 120, "the command takes the cluster's files for its own"
    subprocess.run([command, "batch", manifest.path, "-o", tmp_path / "command"], check=True, capture_output=True)
    assert files_of(tmp_path / "command") == files_of(out)


def test_killed_workers_lose_nothing(slow_client, manifest, device, tmp_path):
    slow_client.wait_for_workers(2, timeout=60)
    stop = threading.Event()
    killed = []

    def kill():
        for _ in range(2):
            if stop.wait(0.5):
                return
            pids = slow_client.run(os.getpid, on_error="ignore")
            if pids:
                pid = sorted(pids.values())[-1]
                os.kill(pid, signal.SIGKILL)
                killed.append(pid)

    killer = threading.Thread(target=kill)
    killer.start()
    try:
        summary = batch.run(manifest, tmp_path / "out", scheduler=slow_client, jobs=1, patience=60)
    finally:
        stop.set()
        killer.join()
    assert killed and summary.workers_lost >= 1 and summary.retried >= 1
    check_complete(summary, manifest, device, tmp_path / "out")


def test_a_worker_that_hangs_is_given_up(slow_client, manifest, device, tmp_path):
    slow_client.wait_for_workers(2, timeout=60)
    pids = slow_client.run(os.getpid)
    stopped = sorted(pids.values())[0]
    timer = threading.Timer(0.4, os.kill, (stopped, signal.SIGSTOP))
    timer.start()
    summary = batch.run(manifest, tmp_path / "out", scheduler=slow_client, jobs=1, timeout=2)
    timer.join()
    assert summary.workers_dismissed == 1 and summary.retried >= 1
    check_complete(summary, manifest, device, tmp_path / "out")


def lie(kind):
    """On a worker: from now on it gives garbage."""
    from pellucid.batch import worker as module

    make = module.make_entry

    def garbage(manifest, index, store, device):
        if kind == "nonsense":
            return ["no", "such", "form"]
        if kind == "device":
            return {"index": index, "file": manifest.entries[index].file, "what": module.DEVICE_FAILED, "message": "on fire"}
        answer = make(manifest, index, store, device)
        data = bytearray(store.read(answer["file"]))
        data[-3] ^= 1
        store.write(answer["file"], bytes(data))
        import hashlib
        return {**answer, "sum": hashlib.sha256(data).hexdigest()}

    module.make_entry = garbage


@pytest.mark.parametrize("kind", ["nonsense", "damaged file", "device"])
def test_garbage_is_noticed_and_done_again_elsewhere(client, manifest, device, tmp_path, kind):
    client.wait_for_workers(2, timeout=60)
    liar = sorted(client.nthreads())[0]
    client.run(lie, kind, workers=[liar])
    summary = batch.run(manifest, tmp_path / "out", scheduler=client)
    assert summary.workers_dismissed >= 1 and summary.retried >= 1 and liar not in summary.made_by
    check_complete(summary, manifest, device, tmp_path / "out")


def test_bad_entries_are_reported_and_the_others_made(tmp_path):
    (tmp_path / "m.toml").write_text('[[lut]]\nsize = 8\n\n[[lut]]\nsize = -3\n\n[[lut]]\nsize = 16384\n[[lut]]\nsize = 9\n')
    result = subprocess.run([sys.executable, "-m", "pellucid.batch", tmp_path / "m.toml", "--out", tmp_path / "out", "--json"],
                            capture_output=True, text=True, timeout=120,
                            env={**os.environ, "POCL_MEMORY_LIMIT": "1"})  # GiB: too little for the large one
    assert result.returncode == 3, result.stderr
    summary = json.loads(result.stdout)
    assert (summary["made"], summary["failed"], summary["workers_dismissed"]) == (2, 2, 0)
    assert "m.toml:5: " in result.stderr and "m.toml:7: given up after 3 attempts" in result.stderr
    assert len(list((tmp_path / "out").iterdir())) == 2


@pytest.mark.parametrize("arguments, code, message", [
    (["m.toml"], 2, "--out"), (["m.toml", "--out", "o", "--timeout", "0"], 2, "--timeout"),
    (["none.toml", "--out", "o"], 3, "none.toml: cannot be read"), (["m.toml", "--out", "m.toml"], 4, "m.toml"),
])
def test_wrong_use(tmp_path, arguments, code, message):
    (tmp_path / "m.toml").write_text(GRID)
    result = subprocess.run([sys.executable, "-m", "pellucid.batch", *arguments], cwd=tmp_path, capture_output=True, text=True,
                            timeout=60)
    assert result.returncode == code and message in result.stderr, result.stderr
    assert "Traceback" not in result.stderr


def test_urls(device, tmp_path):
    fsspec = pytest.importorskip("fsspec")
    (tmp_path / "m.toml").write_text('[[lut]]\nsize = 8\n[[lut]]\nkind = "specular"\nsize = 8\n')
    manifest = batch.Manifest(tmp_path / "m.toml")
    with distributed.Client(processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None) as client:
        assert batch.run(manifest, "memory://tables/here", scheduler=client).made == 2
        assert batch.run(manifest, "memory://tables/here", scheduler=client).kept == 2
        assert batch.run(manifest, f"file://{tmp_path}/local", scheduler=client).made == 2
        with pytest.raises(batch.BatchError, match="nowhere"):
            batch.run(manifest, "nowhere://tables", scheduler=client)
    memory = fsspec.filesystem("memory")
    expected = expected_files(manifest, device)
    assert {name: memory.cat_file(f"/tables/here/{name}") for name in expected} == expected
    assert files_of(tmp_path / "local") == expected


def test_a_manifest_travels_with_its_profiles(device, tmp_path):
    (tmp_path / "own.toml").write_text('name = "own"\nkind = "gaussians"\nunit = "mm"\nsource = "test"\n[[gaussian]]\n'
                                       'variance = 1.0\nweight = [1, 1, 1]\n')
    (tmp_path / "m.toml").write_text('[[lut]]\nsize = 8\nprofile = "own.toml"\n')
    manifest = batch.Manifest(tmp_path / "m.toml")
    packed, file = pickle.dumps(manifest), manifest.make(device, 0)
    (tmp_path / "own.toml").unlink()
    (tmp_path / "m.toml").unlink()
    again = pickle.loads(packed)
    assert again.entries == manifest.entries and again.make(device, 0) == file
    assert manifest.holds(0, file) and not manifest.holds(0, file[:-1])
    with pytest.raises(IndexError):
        manifest.make(device, 1)


def test_a_full_disk_stops_the_batch(client, manifest, tmp_path):
    def full():
        from pellucid.batch import store

        def write(self, name, data):
            raise store.StoreError(f"{name}: cannot be written: No space left on device")

        store.Store.write = write

    client.wait_for_workers(2, timeout=60)
    client.run(full)
    with pytest.raises(batch.BatchError, match="No space left on device") as caught:
        batch.run(manifest, tmp_path / "out", scheduler=client)
    assert caught.value.summary.made == 0
