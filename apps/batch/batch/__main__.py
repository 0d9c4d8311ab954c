"""python -m pellucid.batch MANIFEST --out DIR [--scheduler ADDRESS]: see docs/guide/batch.md. Exit codes as
the command's."""
from __future__ import annotations

import argparse
import json
import math
import sys
from dataclasses import asdict


def main() -> int:
    parser = argparse.ArgumentParser("python -m pellucid.batch", description=(
        "Make the look-up tables of a manifest that are not there yet, on a Dask cluster or the processes of "
        "this machine."))
    add = parser.add_argument
    add("manifest", help="TOML: [[lut]] and [[grid]] (docs/guide/batch.md)")
    add("--out", "-o", required=True, help="a folder that all workers see, or a URL that fsspec knows")
    add("--scheduler", metavar="ADDRESS", help="of a Dask cluster, such as tcp://host:8786; without it: "
                                               "processes of this machine, one per device")
    add("--workers", type=int, metavar="N", help="without --scheduler: how many processes")
    add("--device", action="append", default=[], metavar="D",
        help="without --scheduler: device by number, name or type; several are taken by turns")
    add("--timeout", type=float, default=120, metavar="S",
        help="give up a worker that finishes nothing for this many seconds (default: 120)")
    add("--patience", type=float, default=300, metavar="S",
        help="stop after this many seconds without any worker (default: 300)")
    add("--jobs", "-j", type=int, default=0, metavar="N",
        help="tables in flight per worker (default: four per core)")
    add("--json", action="store_true", help="one JSON object on standard output")
    a = parser.parse_args()
    if a.scheduler and (a.workers or a.device):
        parser.error("--workers and --device are for processes of this machine; with --scheduler the cluster "
                     "has its own")
    times = 0 < a.timeout < math.inf and 0 <= a.patience < math.inf
    if not times or not 0 <= a.jobs <= 256 or (a.workers or 1) < 1 or a.workers == 0:
        parser.error("--timeout must be above 0, --workers 1 or more, --patience 0 or more, --jobs from 0 to "
                     "256")

    def fail(code: int, message: object) -> int:
        print(f"pellucid.batch: {message}", file=sys.stderr)
        return code

    try:
        from . import BatchError, NoWorker, run
    except ImportError as e:
        return fail(4, e)
    error = None
    try:
        summary = run(a.manifest, a.out, scheduler=a.scheduler, workers=a.workers, device=a.device,
                      timeout=a.timeout, jobs=a.jobs, patience=a.patience, progress=True)
    except ValueError as e:
        return fail(3, e)
    except BatchError as e:
        error = e
        if not hasattr(e, "summary"):  # no result at all
            return fail(4 if isinstance(e, NoWorker) else 3, e)
        summary = e.summary
    except KeyboardInterrupt:
        return fail(4, "interrupted; the same command goes on from here")
    if a.json:
        print(json.dumps(asdict(summary), indent=2))
    else:
        print(f"{summary.entries} tables: {summary.made} made ({summary.redone} of them anew), "
              f"{summary.kept} were there, {summary.failed} failed")
    if error is not None:
        return fail(4 if isinstance(error, NoWorker) else 3, error)
    if summary.failed:
        return fail(3, f"{a.manifest}: {summary.failed} of its entries failed; they are listed above")
    return 0


if __name__ == "__main__":
    sys.exit(main())
