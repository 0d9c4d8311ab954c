"""How `python -m pellucid.batch` scales from one worker process to two, and what an entry costs besides its table.

    batch_scaling.py [ENTRIES [REPETITIONS]]

needs the installed package with its extra `batch`. Each worker gets one core (POCL_MAX_PTHREAD_COUNT=1 and one core of this
machine), so that two of them are two devices; files go to memory (/dev/shm) and the tables are large enough to be worth a
processor: the disk, which is one for both, is what bench_batch measures. Prints one JSON object with medians.
"""
import json
import os
import shutil
import statistics
import sys
import tempfile
import time

os.environ["POCL_MAX_PTHREAD_COUNT"] = "1"

from pellucid import batch  # noqa: E402
from pellucid.batch.run import _local_client  # noqa: E402

MANIFEST = """[[grid]]
profile = ["skin", "marble"]
form = "sphere"
axis = "root"
size = {size}
diffusion_radius = {radii}
"""


def pin(core):
    os.sched_setaffinity(0, {core})


def clients(count, cores):
    """A cluster of so many workers, each on a core of its own."""
    with _local_client(count, ()) as client:
        client.wait_for_workers(count, timeout=60)
        for address, core in zip(sorted(client.nthreads()), cores):
            client.run(pin, core, workers=[address])
        yield client


def measured(client, manifest, folder):
    """Entries per second made and kept, and processor seconds per entry of the client and scheduler."""
    shutil.rmtree(folder, ignore_errors=True)
    made = batch.run(manifest, folder, scheduler=client, jobs=2)
    before = time.process_time()
    kept = batch.run(manifest, folder, scheduler=client, jobs=2)
    host = time.process_time() - before
    before = time.process_time()
    trusted = batch.run(manifest, folder, scheduler=client, jobs=2, read_back=False)
    trusting = time.process_time() - before
    assert made.made == kept.kept == trusted.kept == len(manifest)
    return {"made_per_second": made.per_second, "kept_per_second": len(manifest) / kept.total_ms * 1e3,
            "client_us_per_entry": host / len(manifest) * 1e6,
            "client_us_per_entry_without_read_back": trusting / len(manifest) * 1e6}


def main(entries=1200, repetitions=3):
    cores = sorted(os.sched_getaffinity(0))
    scratch = tempfile.mkdtemp(dir="/dev/shm" if os.path.isdir("/dev/shm") else None)
    try:
        manifests = {}
        for size in (64, 256):
            count = entries if size == 64 else entries // 4
            path = os.path.join(scratch, f"{size}.toml")
            with open(path, "w", encoding="ascii") as file:
                file.write(MANIFEST.format(size=size, radii=[round(0.5 + 0.001 * i, 4) for i in range(count // 2)]))
            manifests[size] = batch.Manifest(path)
        results = {}
        for _ in range(repetitions):
            for count in (1, 2):
                for client in clients(count, cores):
                    for size, manifest in manifests.items():
                        batch.run(manifest, os.path.join(scratch, "warm"), scheduler=client, jobs=2)  # programs are built
                        shutil.rmtree(os.path.join(scratch, "warm"))
                        for name, value in measured(client, manifest, os.path.join(scratch, "out")).items():
                            results.setdefault(f"{size}x{size}, {count} workers, {name}", []).append(value)
        print(json.dumps({name: round(statistics.median(values), 1) for name, values in results.items()}, indent=2))
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
