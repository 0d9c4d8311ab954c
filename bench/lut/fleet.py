"""A batch of a million tables on a thousand workers that fail, simulated: how long it takes, and what it waits for.

    fleet.py [--tables N] [--seconds S] [--workers N,...] [--figure docs/figures/fleet.svg] [--json]

An event simulation of the policy of `pellucid.batch` (the sizes of pieces are read from it): pieces go to workers that are free; a worker that dies
takes its piece with it, which others do again, keeping the tables whose files are there; one that hangs is noticed after the timeout. Three things
are shared: the scheduler (pieces a second), the client that reads every file back (tables a second) and the storage (files a second). Each is a queue
with one server. The client's rate was measured on one core (docs/guide/batch.md); those of scheduler and storage are assumptions, to be replaced by one's own.
"""
import argparse
import heapq
import json
import random
import re
from dataclasses import dataclass
from pathlib import Path

DISPATCH = Path(__file__).resolve().parents[2] / "bindings/python/pellucid/batch/dispatch.py"


def policy():
    """The constants of the dispatcher itself."""
    return {name: int(value) for name, value in re.findall(r"^([A-Z_]+) = (\d+)\b", DISPATCH.read_text(), re.M)}


@dataclass
class Fleet:
    workers: int = 1000
    tables: int = 1_000_000
    seconds: float = 0.01  # a table, on a worker, with its file's flush overlapped
    check: float = 0.0004  # a table that is there already: its file is read and verified
    mean_life: float = 24 * 3600  # of a worker, in seconds; dies
    mean_until_hang: float = 30 * 24 * 3600
    renewal: float = 60.0  # until a worker that died has one in its place
    timeout: float = 120.0  # until one that hangs is noticed
    ramp: float = 60.0  # the queue starts all workers within so many seconds
    pieces_per_second: float = 200.0  # scheduler
    reads_per_second: float = 15_600.0  # client, 0: no read-back
    files_per_second: float = 10_000.0  # storage
    seed: int = 1


class Server:
    """One queue with one server: jobs are served in the order of arrival."""

    def __init__(self, rate):
        self.cost, self.free, self.busy = (1 / rate if rate else 0.0), 0.0, 0.0

    def serve(self, now, jobs):
        self.free = max(self.free, now) + jobs * self.cost
        self.busy += jobs * self.cost
        return self.free


def simulate(fleet):
    """Dictionary: `seconds` to the end; `ideal`, without failures and limits; how busy each shared thing was; what was done twice."""
    rules, rng = policy(), random.Random(fleet.seed)
    size = max(1, min(rules["LARGEST_PIECE"], fleet.tables // max(rules["PIECES"], rules["PIECES_PER_WORKER"] * fleet.workers)))
    waiting = [(min(size, fleet.tables - first), 0) for first in range(0, fleet.tables, size)][::-1]  # (tables, of them with a file)
    scheduler, client, storage = Server(fleet.pieces_per_second), Server(fleet.reads_per_second), Server(fleet.files_per_second)
    # Heap of (time, number, what, ...). A worker's life ends at a time drawn when it starts.
    events, number, idle, done, last = [], 0, [], 0, 0.0
    deaths = hangs = again = 0

    def at(time, what, *rest):
        nonlocal number
        number += 1
        heapq.heappush(events, (time, number, what, rest))

    def life(now):
        return now + rng.expovariate(1 / fleet.mean_life), now + rng.expovariate(1 / fleet.mean_until_hang)

    def start(now, worker):
        nonlocal again, deaths, hangs
        tables, there = waiting.pop()
        begin = scheduler.serve(now, 1)
        first = begin + there * fleet.check  # from here on it makes new ones
        dies, hung = worker
        fault = min(dies, hung)
        kept = there + min(tables - there, int(max(0.0, fault - first) / fleet.seconds))
        end = max(first + (kept - there) * fleet.seconds, storage.serve(begin, kept - there))
        if kept == tables and fault > end:
            at(end, "answer", tables, worker)
            return
        again += tables
        deaths, hangs = deaths + (fault == dies), hangs + (fault == hung)
        at(max(fault, begin) + (0.0 if fault == dies else fleet.timeout), "lost", tables, kept)

    for worker in range(fleet.workers):
        at(fleet.ramp * worker / max(fleet.workers - 1, 1), "worker")
    while done < fleet.tables:
        now, _, what, rest = heapq.heappop(events)
        if what == "worker":
            idle.append(life(now))
        elif what == "answer":
            tables, worker = rest
            at(client.serve(now, tables), "read", tables)
            idle.append(worker)
        elif what == "read":
            done += rest[0]
            last = max(last, now)
        else:  # the dispatcher hands it out again, in halves
            tables, kept = rest
            half = tables // 2
            waiting.extend([(n, min(n, k)) for n, k in ((half, min(half, kept)), (tables - half, max(0, kept - half))) if n])
            at(now + fleet.renewal, "worker")
        while idle and waiting:
            worker = idle.pop()
            if worker[0] <= now:  # it died with nothing to do
                deaths += 1
                at(now + fleet.renewal, "worker")
            else:
                start(now, worker)
    shares = {"workers": fleet.tables * fleet.seconds / fleet.workers / last, "scheduler": scheduler.busy / last, "client": client.busy / last,
              "storage": storage.busy / last}
    return {"workers": fleet.workers, "seconds": last, "ideal": fleet.tables * fleet.seconds / fleet.workers, "piece": size, "deaths": deaths, "hangs": hangs,
            "handed_out_again": again, "busy": shares, "limit": max(shares, key=shares.get)}


def figure(path, rows):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "pellucid"
    from matplotlib import pyplot

    fig, ax = pyplot.subplots(figsize=(7, 4.2))
    for label, points in rows.items():
        ax.plot([p["workers"] for p in points], [p["seconds"] / 60 for p in points], marker="o", markersize=3, label=label)
    first = next(iter(rows.values()))
    ax.plot([p["workers"] for p in first], [p["ideal"] / 60 for p in first], "k:", label="tables / workers alone")
    ax.set(xscale="log", yscale="log", xlabel="workers", ylabel="minutes for a million tables")
    ax.grid(True, which="both", alpha=0.3)
    ax.legend(fontsize=8)
    fig.tight_layout()
    fig.savefig(path, metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tables", type=int, default=Fleet.tables)
    parser.add_argument("--seconds", type=float, default=Fleet.seconds, help="a table takes on a worker (default %(default)s)")
    parser.add_argument("--workers", default="10,30,100,300,1000,3000,10000", help="counts, separated by commas")
    parser.add_argument("--figure", metavar="SVG")
    parser.add_argument("--json", action="store_true")
    o = parser.parse_args()
    counts = [int(n) for n in o.workers.split(",")]
    cases = {"no failures": dict(mean_life=1e12, mean_until_hang=1e12), "a worker dies once a day": {},
             "once in ten minutes": dict(mean_life=600.0, mean_until_hang=24 * 3600.0),
             "once a day, files not read back": dict(reads_per_second=0.0),
             "once a day, 1,000 files a second": dict(files_per_second=1000.0)}
    rows = {name: [simulate(Fleet(workers=n, tables=o.tables, seconds=o.seconds, **case)) for n in counts] for name, case in cases.items()}
    if o.figure:
        figure(o.figure, rows)
    if o.json:
        print(json.dumps(rows, indent=1))
        return
    for name, points in rows.items():
        print(name)
        for p in points:
            print(f"  {p['workers']:6} workers {p['seconds'] / 60:8.2f} min (ideal {p['ideal'] / 60:8.2f}), pieces of {p['piece']:4}, {p['deaths']:5} deaths, "
                  f"{p['hangs']:3} hangs, {p['handed_out_again']:7} handed out again; " + ", ".join(f"{k} {v:.0%}" for k, v in p["busy"].items()) + f" -> {p['limit']}")


if __name__ == "__main__":
    main()
