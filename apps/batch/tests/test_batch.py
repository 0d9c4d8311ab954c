"""Batches on a cluster of real processes, some of which are killed, stopped, or return wrong answers. Writing
files atomically is code of the command and tested there."""
import contextlib
import hashlib
import itertools
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import cloudpickle
import distributed
import fsspec
import psutil
import pytest

import pellucid as pel

batch = pytest.importorskip("pellucid.batch", reason="the package was built without toml++")

from pellucid.batch import __main__, dispatch, store  # noqa: E402
from pellucid.batch.run import _local_client  # noqa: E402

cloudpickle.register_pickle_by_value(sys.modules[__name__])  # workers cannot import a test


def grid(radii):
    return ('[[grid]]\nsize = [8, 12]\nencoding = ["half", "float"]\ndiffusion_radius = '
            f'{[round(1 + 0.001 * i, 3) for i in range(radii)]}\n')


@contextlib.contextmanager
def processes(count, kinds=(), timeout=120):
    """A client of fresh processes and their names. The first of them misbehave; a process that is started in
    place of one of them does not."""
    with _local_client(count, (), timeout=timeout) as client:
        client.wait_for_workers(count, timeout=120)
        names = sorted(client.nthreads())
        for name, kind in zip(names, kinds):
            client.run(misbehave, kind, workers=[name])
        yield client, names


@pytest.fixture(scope="module")
def client():
    """Two processes that no test kills or stops."""
    with processes(2) as (client, _):
        yield client


@pytest.fixture
def manifest(tmp_path):
    (tmp_path / "m.toml").write_text(grid(30))
    return batch.Manifest(tmp_path / "m.toml")


def files_of(folder):
    """Without the index and the temporary files of workers that died."""
    return {p.name: p.read_bytes() for p in folder.glob("[!.]*.exr")}


@pytest.fixture
def check(manifest, tmp_path):
    """Runs the manifest and compares the files with those that one process makes."""
    device = pel.Device()
    expected = {e.file: manifest.make(device, i) for i, e in enumerate(manifest.entries)}

    def run(client, **options):
        summary = batch.run(manifest, tmp_path / "out", scheduler=client, **options)
        assert summary.made + summary.kept == summary.entries == 120 and summary.failed == 0
        assert sum(summary.made_by.values()) == summary.made
        assert files_of(tmp_path / "out") == expected
        return summary

    return run


def test_the_same_bytes_as_one_process_and_resumed(client, manifest, check, tmp_path):
    out = tmp_path / "out"
    summary = check(client)
    assert (summary.made, summary.kept, summary.retried, len(summary.made_by)) == (120, 0, 0, 2)
    names = sorted(e.file for e in manifest.entries)
    whole = (out / names[1]).read_bytes()
    (out / names[0]).unlink()
    (out / names[1]).write_bytes(whole[:-9])
    (out / names[2]).write_bytes(whole)  # another entry's
    again = check(client)
    assert (again.made, again.redone, again.kept) == (3, 2, 117)
    command = os.environ.get("PELLUCID_COMMAND")
    if not command:
        pytest.skip("PELLUCID_COMMAND does not name the built command")
    report = subprocess.run([command, "batch", manifest.path, "-o", out, "--json"], check=True,
                            capture_output=True)
    assert json.loads(report.stdout)["kept"] == 120, "the command takes the cluster's files for its own"


def misbehave(kind, pid=0):
    """On a worker: from its third entry on it does this."""
    from pellucid.batch import worker as module

    make, calls = module.make_entry, itertools.count(1)

    def make_entry(manifest, index, store, device):
        if next(calls) < 3:
            return make(manifest, index, store, device)
        if kind == "dies":
            os.kill(pid or os.getpid(), signal.SIGKILL)
        elif kind == "hangs":
            os.kill(os.getpid(), signal.SIGSTOP)
        elif kind == "waits":
            time.sleep(3600)
        elif kind == "nonsense":
            return ["no", "such", "form"]
        elif kind == "device":
            return index, module.DEVICE_FAILED, "on fire"
        elif kind == "full":
            return index, module.NO_STORE, "No space left on device"
        _, what, _ = make(manifest, index, store, device)
        if kind == "damaged file":
            file = manifest.entries[index].file
            data = bytearray(store.read(file))
            data[-3] ^= 1
            store.write(file, bytes(data))
            return index, what, hashlib.sha256(data).hexdigest()
        return index, what, ""

    if kind == "without":
        sys.modules["pellucid.batch.worker"] = None  # as if it were not installed there
    elif kind == "older":
        module.__version__ = "0.0.9"
    else:
        module.make_entry = make_entry


def test_all_workers_gone_at_once(check):
    """Work submitted for one worker goes to any worker that appears later."""
    with processes(2, ["nonsense", "dies"]) as (client, _):
        summary = check(client, jobs=1)
        assert summary.workers_dismissed == 1 and summary.workers_lost >= 1


def test_workers_that_hang_are_given_up(check):
    """A stopped process, which Dask notices, and a call that does not return, which the process itself does.
    """
    with processes(3, ["hangs", "waits"], timeout=3) as (client, _):
        summary = check(client, jobs=1, timeout=3)
        assert summary.workers_dismissed + summary.workers_lost >= 2


def test_garbage_is_noticed_and_done_again_elsewhere(check):
    with processes(4, ["nonsense", "damaged file", "device"]) as (client, names):
        summary = check(client)
        assert summary.workers_dismissed >= 3 and summary.retried >= 3
        assert all(summary.made_by.get(liar, 0) <= 2 for liar in names[:3])


def test_what_a_dismissed_worker_wrote_over_is_made_again(check, tmp_path):
    with processes(2, ["nonsense"]) as (client, _):
        restart, damaged = client.restart_workers, []

        def late(*arguments, **options):
            if not damaged:
                damaged.append(min((tmp_path / "out").glob("[!.]*.exr")))
                damaged[0].write_bytes(damaged[0].read_bytes()[:-9])
            return restart(*arguments, **options)

        client.restart_workers = late
        assert check(client).workers_dismissed >= 1 and damaged


def test_unfit_workers_get_no_work_and_cost_none(check, capsys):
    with processes(3, ["older", "without"]) as (client, names):
        summary = check(client, progress=True)
        assert (summary.workers_dismissed, summary.retried, list(summary.made_by)) == (2, 0, names[2:])
        error = capsys.readouterr().err
        assert f"it has pellucid 0.0.9 where the batch was started with {pel.__version__}" in error
        assert "install pellucid[batch] in the environment of the workers" in error
        assert set(names) == set(client.nthreads()), "a restart would not help"


def test_every_file_is_read_back(client, manifest, tmp_path, monkeypatch):
    names, read = [], store.Store.read
    monkeypatch.setattr(store.Store, "read", lambda self, name: names.append(name) or read(self, name))
    assert batch.run(manifest, tmp_path / "out", scheduler=client).made == 120
    assert sorted(names) == sorted(e.file for e in manifest.entries)


def test_a_full_disk_stops_the_batch(manifest, tmp_path):
    with processes(1, ["full"]) as (client, _), pytest.raises(batch.BatchError,
                                                              match="No space left on device") as caught:
        batch.run(manifest, tmp_path / "out", scheduler=client, jobs=1)
    assert caught.value.summary.made < 120


def test_a_cluster_object_whose_workers_come_late(check, tmp_path):
    with distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None) as cluster:
        threading.Timer(1.0, cluster.scale, [1]).start()
        check(cluster)
        with pytest.raises(ValueError, match="cluster.scale"):
            batch.run(tmp_path / "m.toml", tmp_path / "out", scheduler=cluster, workers=3)


def test_a_scheduler_that_dies(client, manifest, check, tmp_path):
    def start(*what):
        return subprocess.Popen([sys.executable, "-m", *what, "--host", "127.0.0.1", "--no-dashboard",
                                 "--scheduler-file", tmp_path / "scheduler.json"],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    scheduler = start("distributed.cli.dask_scheduler", "--port", "0")
    worker = start("distributed.cli.dask_worker", "--no-nanny", "--nthreads", "1", "--death-timeout", "120")
    try:
        while not (tmp_path / "scheduler.json").exists():
            assert scheduler.poll() is None
            time.sleep(0.02)
        with distributed.Client(scheduler_file=str(tmp_path / "scheduler.json"), timeout=5) as doomed:
            doomed.wait_for_workers(1, timeout=120)
            doomed.run(misbehave, "dies", scheduler.pid)
            with pytest.raises(batch.NoWorker, match="the same call goes on") as caught:
                batch.run(manifest, tmp_path / "out", scheduler=doomed, jobs=1)
    finally:
        for process in (worker, scheduler):
            process.kill()
            process.wait()
    assert caught.value.summary.made < 120
    assert check(client).kept >= 2


def test_nobody_else_reaches_the_processes_of_this_machine(client):
    processes = {os.getpid(), *client.run(os.getpid).values(), *client.run(os.getppid).values()}
    found = [c.laddr.ip for process in processes for c in psutil.Process(process).net_connections("tcp")
             if c.status == psutil.CONN_LISTEN]
    assert len(found) >= 3, "scheduler, nannies and workers listen"
    assert set(found) == {"127.0.0.1"}


@pytest.mark.parametrize("when", ["processes start", "tables are made"])
def test_ctrl_c_ends_it_quietly(tmp_path, when):
    (tmp_path / "m.toml").write_text(grid(4000))  # more than there is time for
    process = subprocess.Popen([sys.executable, "-m", "pellucid.batch", "m.toml", "--out", "out", "--workers",
                                "2"], cwd=tmp_path, stderr=subprocess.PIPE, text=True, start_new_session=True,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))

    def is_time():
        if when == "tables are made":
            return (tmp_path / "out").exists() and any((tmp_path / "out").iterdir())
        return len(psutil.Process(process.pid).children()) >= 2  # one is Python's tracker of resources

    while not is_time():
        assert process.poll() is None
        time.sleep(0.02)
    if when == "processes start":
        time.sleep(0.5)  # they import modules
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers as well
    error = process.communicate(timeout=120)[1]
    assert process.returncode == 4, error
    assert error.endswith("interrupted; the same command goes on from here\n") and "Traceback" not in error


def test_ctrl_c_in_a_finalizer_ends_it(client, manifest, tmp_path, monkeypatch):
    class Interrupted:
        def __del__(self):
            signal.raise_signal(signal.SIGINT)

    def handle(*arguments, handle=dispatch.Dispatcher._handle):
        Interrupted()
        handle(*arguments)

    monkeypatch.setattr(dispatch.Dispatcher, "_handle", handle)
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)  # tests may run with it ignored
    try:
        with pytest.raises(KeyboardInterrupt):
            batch.run(manifest, tmp_path / "out", scheduler=client)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, handler)


def test_bad_entries_are_reported_and_the_others_made(tmp_path):
    (tmp_path / "m.toml").write_text('[[lut]]\nsize = 8\n\n[[lut]]\nsize = -3\n\n[[lut]]\nsize = 8192\n'
                                     '[[lut]]\nsize = 9\n')
    result = subprocess.run([sys.executable, "-m", "pellucid.batch", "m.toml", "--out", "out", "--json"],
                            cwd=tmp_path, capture_output=True, text=True, timeout=120,
                            env={**os.environ, "POCL_MEMORY_LIMIT": "1"})  # GiB: less than the large one
    assert result.returncode == 3, result.stderr
    summary = json.loads(result.stdout)
    assert (summary["made"], summary["failed"], summary["workers_dismissed"]) == (2, 2, 0)
    assert "m.toml:5: " in result.stderr and "m.toml:7: given up after 3 attempts" in result.stderr
    assert len(files_of(tmp_path / "out")) == 2
    index = json.loads((tmp_path / "out/m.index.json").read_text())
    assert len(index["tables"]) == 2 and index["missing"] == 2


@pytest.mark.parametrize("arguments, code, message", [
    (["m.toml"], 2, "--out"), (["m.toml", "--out", "o", "--timeout", "0"], 2, "--timeout"),
    (["m.toml", "--out", "o", "--device", "none"], 4, '"none" matches no OpenCL device'),
    (["m.toml", "--out", "o", "--scheduler", "here"], 4, "no Dask scheduler at here: missing port number"),
    (["none.toml", "--out", "o"], 3, "none.toml: cannot be read"),
    (["m.toml", "--out", "m.toml"], 3, "m.toml: is not a folder"),
    (["m.toml", "--out", "memory://o"], 3, "share no memory"),
    (["m.toml", "--out", "o", "--timeout", "nan"], 2, "--timeout must be above 0"),
    (["m.toml", "--out", "o", "--patience", "inf"], 2, "--patience 0 or more"),
])
def test_wrong_use(tmp_path, monkeypatch, capsys, arguments, code, message):
    (tmp_path / "m.toml").write_text(grid(1))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["batch", *arguments])
    monkeypatch.setattr(distributed, "SpecCluster", lambda **_: pytest.fail("processes are started"))
    try:
        status = __main__.main()
    except SystemExit as e:  # of argparse
        status = e.code
    error = capsys.readouterr().err
    assert status == code and message in error, error


def test_urls(tmp_path):
    (tmp_path / "m.toml").write_text('[[lut]]\nsize = 8\n[[lut]]\nkind = "specular"\nsize = 8\n')
    with distributed.Client(processes=False, n_workers=1, threads_per_worker=1,
                            dashboard_address=None) as client:
        for made in (2, 0):
            assert batch.run(tmp_path / "m.toml", "memory://tables/here", scheduler=client).made == made
        assert batch.run(tmp_path / "m.toml", f"file://{tmp_path}/local", scheduler=client).made == 2
        with pytest.raises(batch.BatchError, match="nowhere"):
            batch.run(tmp_path / "m.toml", "nowhere://tables", scheduler=client)
    local, memory = files_of(tmp_path / "local"), fsspec.filesystem("memory")
    assert len(local) == 2
    assert {name: memory.cat_file(f"/tables/here/{name}") for name in local} == local


def test_a_folder_that_has_gone_and_what_is_no_file(tmp_path):
    gone = store.Store(tmp_path / "gone")
    assert gone.read("a.exr") is None
    os.mkfifo(tmp_path / "pipe.exr")
    (tmp_path / "folder.exr").mkdir()
    (tmp_path / "loop.exr").symlink_to("loop.exr")
    for name in ("pipe.exr", "folder.exr", "loop.exr"):  # an error of that entry alone
        with pytest.raises(store.InTheWay, match=f"{name} is in the way"):
            store.Store(tmp_path).read(name)
    for folder, name, message in ((gone, "a.exr", "there is no folder"),
                                  (store.Store(tmp_path), "pipe.exr", "must be the name of a file")):
        with pytest.raises(store.StoreError, match=message):
            folder.write(name, b"new")


def test_a_manifest_travels_with_its_profiles(tmp_path):
    (tmp_path / "own.toml").write_text('name = "own"\nkind = "gaussians"\nunit = "mm"\nsource = "test"\n'
                                       '[[gaussian]]\nvariance = 1.0\nweight = [1, 1, 1]\n')
    (tmp_path / "m.toml").write_text('[[lut]]\nsize = 8\nprofile = "own.toml"\n'
                                     '[[grid]]\nsize = 8\nmelanin = [0.01, 0.1]\nstack = 2\n')
    device, manifest = pel.Device(), batch.Manifest(tmp_path / "m.toml")
    packed, files = pickle.dumps(manifest), [manifest.make(device, i) for i in range(2)]
    (tmp_path / "own.toml").unlink()
    (tmp_path / "m.toml").unlink()
    again = pickle.loads(packed)
    assert again.entries == manifest.entries
    for i, file in enumerate(files):
        assert again.make(device, i) == file
        assert manifest.holds(i, file) and not manifest.holds(i, file[:-1])
    with pytest.raises(IndexError):
        manifest.make(device, 2)
