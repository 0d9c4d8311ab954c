"""The simulation of a fleet (bench/lut/fleet.py): what it must give where the answer is known, and that nothing is lost."""
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench/lut"))
from fleet import Fleet, simulate  # noqa: E402

NEVER = dict(mean_life=1e15, mean_until_hang=1e15)
UNLIMITED = dict(pieces_per_second=0.0, reads_per_second=0.0, files_per_second=0.0)


class FleetTest(unittest.TestCase):
    def test_workers_alone(self):
        # 64 workers, pieces of 195 or fewer: 1,000 tables of a second each for every worker, and one piece at most at the end.
        r = simulate(Fleet(workers=64, tables=64_000, seconds=1.0, ramp=0.0, **NEVER, **UNLIMITED))
        self.assertGreaterEqual(r["seconds"], 1000.0)
        self.assertLess(r["seconds"], 1000.0 + r["piece"])
        self.assertEqual((r["deaths"], r["handed_out_again"], r["limit"]), (0, 0, "workers"))

    def test_each_shared_thing_can_be_the_limit(self):
        for limit, rates in (("storage", dict(files_per_second=100.0)), ("client", dict(reads_per_second=100.0))):
            r = simulate(Fleet(workers=100, tables=50_000, seconds=0.001, ramp=0.0, **NEVER, **(UNLIMITED | rates)))
            self.assertEqual(r["limit"], limit)
            self.assertAlmostEqual(r["seconds"], 500.0, delta=10.0)
        r = simulate(Fleet(workers=1000, tables=50_000, seconds=0.001, ramp=0.0, **NEVER, **(UNLIMITED | dict(pieces_per_second=10.0))))
        self.assertEqual(r["limit"], "scheduler")
        self.assertAlmostEqual(r["seconds"], 50_000 / r["piece"] / 10, delta=10.0)

    def test_failures_cost_time_and_no_table(self):
        calm = simulate(Fleet(workers=50, tables=100_000, seconds=0.5, **NEVER))
        rough = simulate(Fleet(workers=50, tables=100_000, seconds=0.5, mean_life=600.0, mean_until_hang=3600.0))
        self.assertGreater(rough["deaths"], 50)
        self.assertGreater(rough["hangs"], 3)
        self.assertGreater(rough["seconds"], calm["seconds"])
        # 60 of 660 s of each life are the wait for the next, 120 of 3,600 s a hang; pieces halve as they are lost.
        self.assertLess(rough["seconds"], 1.5 * calm["seconds"])
        self.assertEqual(rough, simulate(Fleet(workers=50, tables=100_000, seconds=0.5, mean_life=600.0, mean_until_hang=3600.0)))


if __name__ == "__main__":
    unittest.main()
