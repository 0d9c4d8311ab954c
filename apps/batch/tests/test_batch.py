"""Batches on a cluster of real processes, some of which are killed, stopped or lie."""
import contextlib
import hashlib
import json
import os
import pickle
import signal
import subprocess
import sys
import time

import pytest

import pellucid as pel

distributed = pytest.importorskip("distributed",
                                  reason="distributed is not installed: pip install pellucid[batch]")
cloudpickle = pytest.importorskip("cloudpickle")
batch = pytest.importorskip("pellucid.batch", reason="the package was built without toml++")

from pellucid.batch.run import _local_client  # noqa: E402

cloudpickle.register_pickle_by_value(sys.modules[__name__])  # workers cannot import a test

RADII = [round(1 + 0.01 * i, 2) for i in range(30)]
GRID = f'[[grid]]\nsize = [8, 12]\nencoding = ["half", "float"]\ndiffusion_radius = {RADII}\n'


@pytest.fixture
def client():
    """Two fresh processes, so that what a test does to them ends with it. A process that is started in place
    of one is clean."""
    with _local_client(2, ()) as client:
        client.wait_for_workers(2, timeout=120)
        yield client


@pytest.fixture
def manifest(tmp_path):
    (tmp_path / "m.toml").write_text(GRID)
    return batch.Manifest(tmp_path / "m.toml")


def files_of(folder):
    return {p.name: p.read_bytes() for p in folder.iterdir() if p.suffix != ".json"}


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
    report = subprocess.run([command, "batch", manifest.path, "-o", out, "--json"], check=True,
                            capture_output=True)
    assert json.loads(report.stdout)["kept"] == 120, "the command takes the cluster's files for its own"
    subprocess.run([command, "batch", manifest.path, "-o", tmp_path / "command"], check=True,
                   capture_output=True)
    assert files_of(tmp_path / "command") == files_of(out)


def misbehave(kind):
    """On a worker: from its third entry on it does this."""
    import itertools

    from pellucid.batch import worker as module

    make, calls = module.make_entry, itertools.count(1)

    def make_entry(manifest, index, store, device):
        if next(calls) < 3:
            return make(manifest, index, store, device)
        if kind == "dies":
            os.kill(os.getpid(), signal.SIGKILL)
        if kind == "hangs":
            os.kill(os.getpid(), signal.SIGSTOP)
        if kind == "waits":
            time.sleep(3600)
        if kind == "nonsense":
            return ["no", "such", "form"]
        if kind == "device":
            return {"index": index, "file": manifest.entries[index].file, "what": module.DEVICE_FAILED,
                    "message": "on fire"}
        answer = make(manifest, index, store, device)
        file = manifest.entries[index].file
        data = bytearray(store.read(file))
        data[-3] ^= 1
        store.write(file, bytes(data))
        return {**answer, "sum": hashlib.sha256(data).hexdigest()}

    if kind == "without":
        sys.modules["pellucid.batch.worker"] = None  # as if it were not installed there
    elif kind == "older":
        module.__version__ = "0.0.9"
    else:
        module.make_entry = make_entry


def listening(processes):
    """Addresses at which these processes wait for connections, as hexadecimal digits of /proc/net."""
    sockets = set()
    for process in processes:
        for fd in os.listdir(f"/proc/{process}/fd"):
            with contextlib.suppress(OSError):
                sockets.add(os.readlink(f"/proc/{process}/fd/{fd}"))
    found = []
    for table in ("tcp", "tcp6"):
        for line in open(f"/proc/net/{table}").readlines()[1:]:
            words = line.split()
            if words[3] == "0A" and f"socket:[{words[9]}]" in sockets:
                found.append(words[1].split(":")[0])
    return found


def test_nobody_else_reaches_the_processes_of_this_machine(client):
    processes = {os.getpid(), *client.run(os.getpid).values(), *client.run(os.getppid).values()}
    found = listening(processes)
    assert len(found) >= 3, "scheduler, nannies and workers listen"
    assert set(found) == {"0100007F"}, "at 127.0.0.1 alone"


def test_killed_workers_lose_nothing(client, manifest, device, tmp_path):
    client.run(misbehave, "dies")
    summary = batch.run(manifest, tmp_path / "out", scheduler=client, jobs=1)
    assert summary.workers_lost >= 2
    check_complete(summary, manifest, device, tmp_path / "out")


@pytest.mark.parametrize("kind", ["hangs", "waits"])
def test_a_worker_that_hangs_is_given_up(manifest, device, tmp_path, kind):
    """A stopped process, which Dask notices, and a call that does not return, which the process itself does.
    """
    with _local_client(2, (), timeout=3) as client:
        client.wait_for_workers(2, timeout=120)
        client.run(misbehave, kind, workers=[min(client.nthreads())])
        summary = batch.run(manifest, tmp_path / "out", scheduler=client, jobs=1, timeout=3)
        assert summary.workers_dismissed + summary.workers_lost >= 1
        check_complete(summary, manifest, device, tmp_path / "out")


@pytest.mark.parametrize("kind", ["nonsense", "damaged file", "device"])
def test_garbage_is_noticed_and_done_again_elsewhere(client, manifest, device, tmp_path, kind):
    liar = min(client.nthreads())
    client.run(misbehave, kind, workers=[liar])
    summary = batch.run(manifest, tmp_path / "out", scheduler=client)
    assert summary.workers_dismissed >= 1 and summary.retried >= 1 and summary.made_by.get(liar, 0) <= 2
    check_complete(summary, manifest, device, tmp_path / "out")


def test_every_file_is_read_back_unless_told_not_to(client, manifest, tmp_path, monkeypatch):
    from pellucid.batch.store import Store

    names, read = [], Store.read
    monkeypatch.setattr(Store, "read", lambda self, name: names.append(name) or read(self, name))
    assert batch.run(manifest, tmp_path / "trusted", scheduler=client, read_back=False).made == 120
    assert not names
    assert batch.run(manifest, tmp_path / "trusted", scheduler=client).kept == 120
    assert sorted(names) == sorted(e.file for e in manifest.entries)


@pytest.mark.parametrize("kind, message",
                         [("older", f"it has pellucid 0.0.9 where the batch was started with "
                                    f"{pel.__version__}"),
                                           ("without", "install pellucid[batch] in the environment of the "
                                                       "workers")])
def test_an_unfit_worker_gets_no_work_and_costs_none(client, manifest, device, tmp_path, capsys, kind,
                                                     message):
    unfit = min(client.nthreads())
    client.run(misbehave, kind, workers=[unfit])
    summary = batch.run(manifest, tmp_path / "out", scheduler=client, progress=True)
    assert (summary.workers_dismissed, summary.retried, list(
        summary.made_by)) == (1, 0, [max(client.nthreads())])
    assert message in capsys.readouterr().err
    assert unfit in client.nthreads(), "a restart would not help"
    check_complete(summary, manifest, device, tmp_path / "out")


def test_a_cluster_is_asked_for_workers_again(manifest, device, tmp_path, monkeypatch):
    """One whose first worker comes when it is asked a second time."""
    from pellucid.batch import dispatch

    monkeypatch.setattr(dispatch, "ASK_AGAIN_SECONDS", 0.1)
    asked = []
    with distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None) as cluster:
        scale = cluster.scale
        with monkeypatch.context() as patched:
            patched.setattr(cluster, "scale", lambda n: asked.append(n) or len(asked) > 1 and scale(1))
            summary = batch.run(manifest, tmp_path / "out", scheduler=cluster, workers=3)
        with pytest.raises(ValueError, match="cannot start any"):
            batch.run(manifest, tmp_path / "out", scheduler=cluster.scheduler_address, workers=3)
    assert len(asked) > 1 and set(asked) == {3}
    check_complete(summary, manifest, device, tmp_path / "out")


def test_a_cluster_that_adapts(manifest, device, tmp_path):
    """Dask starts workers because work waits."""
    with distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None) as cluster:
        cluster.adapt(minimum=0, maximum=2, interval="100ms")
        summary = batch.run(manifest, tmp_path / "out", scheduler=cluster)
    check_complete(summary, manifest, device, tmp_path / "out")


def test_a_scheduler_that_dies(client, manifest, device, tmp_path):
    def start(*what):
        return subprocess.Popen([sys.executable, "-m", *what, "--host", "127.0.0.1", "--no-dashboard",
                                 "--scheduler-file",
                                 tmp_path / "scheduler.json"], stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)

    scheduler = start("distributed.cli.dask_scheduler", "--port", "0")
    worker = start("distributed.cli.dask_worker", "--no-nanny", "--nthreads", "1", "--death-timeout", "120")
    try:
        while not (tmp_path / "scheduler.json").exists():
            assert scheduler.poll() is None
            time.sleep(0.02)
        with distributed.Client(scheduler_file=str(tmp_path / "scheduler.json"), timeout=10) as doomed:
            doomed.wait_for_workers(1, timeout=120)
            doomed.run(kill_at_third_entry, scheduler.pid)
            with pytest.raises(batch.NoWorker, match="the same call goes on") as caught:
                batch.run(manifest, tmp_path / "out", scheduler=doomed, jobs=1)
    finally:
        for process in (worker, scheduler):
            process.kill()
            process.wait()
    assert caught.value.summary.made < 120
    summary = batch.run(manifest, tmp_path / "out", scheduler=client)
    assert summary.kept >= 2
    check_complete(summary, manifest, device, tmp_path / "out")


def kill_at_third_entry(pid):
    """On a worker."""
    import itertools

    from pellucid.batch import worker as module

    make, calls = module.make_entry, itertools.count(1)

    def make_entry(*arguments):
        if next(calls) == 3:
            os.kill(pid, signal.SIGKILL)
        return make(*arguments)

    module.make_entry = make_entry


def test_ctrl_c_ends_it_quietly(tmp_path):
    radii = [round(1 + 0.001 * i, 3) for i in range(4000)]  # more than there is time for
    (tmp_path / "m.toml").write_text(f'[[grid]]\nsize = [8, 12]\nencoding = ["half", '
                                     f'"float"]\ndiffusion_radius = {radii}\n')
    process = subprocess.Popen([sys.executable, "-m", "pellucid.batch", "m.toml", "--out", "out", "--workers",
                                "2"], cwd=tmp_path,
                               stderr=subprocess.PIPE, text=True, start_new_session=True,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
    while not (tmp_path / "out").exists() or not any((tmp_path / "out").iterdir()):
        assert process.poll() is None
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers as well
    error = process.communicate(timeout=120)[1]
    assert process.returncode == 4 and "interrupted; the same command goes on from here" in error, error
    assert "Traceback" not in error


def test_bad_entries_are_reported_and_the_others_made(tmp_path):
    (tmp_path / "m.toml").write_text('[[lut]]\nsize = 8\n\n[[lut]]\nsize = -3\n\n[[lut]]\nsize = '
                                     '8192\n[[lut]]\nsize = 9\n')
    result = subprocess.run([sys.executable, "-m", "pellucid.batch", tmp_path / "m.toml", "--out",
                             tmp_path / "out", "--json"],
                            capture_output=True, text=True, timeout=120,
                            env={**os.environ, "POCL_MEMORY_LIMIT": "1"})  # GiB: too little for the large one
    assert result.returncode == 3, result.stderr
    summary = json.loads(result.stdout)
    assert (summary["made"], summary["failed"], summary["workers_dismissed"]) == (2, 2, 0)
    assert "m.toml:5: " in result.stderr and "m.toml:7: given up after 3 attempts" in result.stderr
    assert len(list((tmp_path / "out").glob("*.exr"))) == 2
    index = json.loads((tmp_path / "out/m.index.json").read_text())
    assert len(index["tables"]) == 2 and index["missing"] == 2


@pytest.mark.parametrize("arguments, code, message", [
    (["m.toml"], 2, "--out"), (["m.toml", "--out", "o", "--timeout", "0"], 2, "--timeout"),
    (["m.toml", "--out", "o", "--device", "none"], 4, '"none" matches no OpenCL device'),
    (["m.toml", "--out", "o", "--scheduler", "here"], 4, "no Dask scheduler at here: missing port number"),
    (["none.toml", "--out", "o"], 3, "none.toml: cannot be read"),
    (["m.toml", "--out", "m.toml"], 3, "m.toml: is not a folder"),
])
def test_wrong_use(tmp_path, arguments, code, message):
    (tmp_path / "m.toml").write_text(GRID)
    result = subprocess.run([sys.executable, "-m", "pellucid.batch", *arguments], cwd=tmp_path,
                            capture_output=True, text=True,
                            timeout=60)
    assert result.returncode == code and message in result.stderr, result.stderr
    assert "Traceback" not in result.stderr


def test_urls(device, tmp_path):
    fsspec = pytest.importorskip("fsspec")
    (tmp_path / "m.toml").write_text('[[lut]]\nsize = 8\n[[lut]]\nkind = "specular"\nsize = 8\n')
    manifest = batch.Manifest(tmp_path / "m.toml")
    with distributed.Client(processes=False, n_workers=1, threads_per_worker=1,
                            dashboard_address=None) as client:
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
    (tmp_path / "own.toml").write_text('name = "own"\nkind = "gaussians"\nunit = "mm"\nsource = '
                                       '"test"\n[[gaussian]]\n'
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

    client.run(full)
    with pytest.raises(batch.BatchError, match="No space left on device") as caught:
        batch.run(manifest, tmp_path / "out", scheduler=client)
    assert caught.value.summary.made == 0
