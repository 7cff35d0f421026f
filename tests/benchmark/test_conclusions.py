"""Tables and conclusions of contests with invented figures."""

import json
import unittest

import conclusions
import contests
import measure
import peers3
import tables
from contests import ALONE, DECODER, FROM_LAZ, HXT_TWICE, OURS, OURS_TWICE

MB = 10**6
COUNT = 1000
FLOOR = 20 * MB


def contestant(name, seconds, megabytes=100, first_round=1):
    """A contestant with these times, of rounds from `first_round` on."""
    found = measure.Contestant(name, [["program"]])
    for number, time in enumerate(seconds, first_round):
        said = {"seconds": time, "tetrahedra": 7, "triangles": 7}
        found.runs.append(measure.Run(time, [time], [megabytes * MB], said, round=number, floor=FLOOR))
    return found


def lines(name, dims, *found):
    contest = contests.Contest(name, COUNT, list(found), dims=dims)
    return "\n".join(conclusions.lines(contest)), tables.contest(contest), conclusions.as_json(contest)


class Conclusions(unittest.TestCase):
    def test_kernels_in_space(self):
        words, table, facts = lines(
            "uniform3-1k",
            3,
            contestant(OURS, [1.0, 2.0, 3.0]),
            contestant(OURS_TWICE, [0.5, 1.25, 1.0], megabytes=125),
            contestant(peers3.CGAL, [3.0, 5.0, 9.0], megabytes=400),
            contestant(peers3.HXT, [1.5, 2.0, 2.7], megabytes=200),
            contestant(HXT_TWICE, [1.0, 1.5, 2.0], megabytes=250),
        )
        self.assertIn("1.00 (0.900 to 1.50) times as fast as HXT, the fastest peer, not distinguishable", words)
        self.assertIn("3.00 (2.50 to 3.00) times as fast as CGAL", words)
        self.assertIn("0.333 (0.333 to 0.400) times the CPU time of CGAL", words)
        self.assertIn("0.250 (0.250 to 0.250) times the peak memory of CGAL", words)
        self.assertIn("2.00 (1.60 to 3.00) times as fast on two threads as on one: spmesh, 2 threads", words)
        self.assertIn("1.25 (1.25 to 1.25) times the peak memory of one, on two threads", words)
        self.assertIn("2.00 (1.20 to 2.00) times as fast as HXT, on two threads each", words)
        self.assertIn("ranks 1 and 3 of 3 rounds, 75 %", table)
        rounds = {(entry["over"], entry.get("under"), entry["of"]): entry["rounds"] for entry in facts["ratios"]}
        self.assertEqual(rounds[peers3.CGAL, OURS, "seconds"], {1: 3.0, 2: 2.5, 3: 3.0})
        self.assertEqual(rounds[OURS, OURS_TWICE, "seconds"], {1: 2.0, 2: 1.6, 3: 3.0})
        json.dumps(facts)

    def test_a_slow_peer_has_no_interval(self):
        slow = contestant("CDT", [40.0], first_round=0)
        words, table, _ = lines("uniform-1k", 2, contestant(OURS, [1.0, 2.0, 3.0]), slow)
        self.assertIn("20.00 (no interval) times as fast as CDT", words)
        self.assertIn("run once has no interval", table)

    def test_from_laz(self):
        words, _, facts = lines(
            "pipe-1k",
            2,
            contestant(OURS, [1.8, 1.8]),
            contestant(FROM_LAZ, [3.0, 6.6]),
            contestant(DECODER, [1.0, 2.0]),
            contestant(ALONE.format(1), [3.0, 7.0]),
            contestant(ALONE.format(2), [2.0, 4.0]),
        )
        self.assertIn("LAZ to mesh (4.80 s): 1.05 (1.00 to 1.10) times as long as one parallel decoding", words)
        self.assertIn("1.15 (1.00 to 1.30) times the decoding, not distinguishable", words)
        self.assertIn("1.62 (1.50 to 1.75) times as fast on two threads as on one", words)
        named = {entry["over"]: entry["rounds"] for entry in facts["ratios"] if "under" not in entry}
        self.assertEqual(named["LAZ to decoding and triangulation"], {1: 1.0, 2: 6.6 / 6.0})

    def test_peaks_near_the_floor_are_not_compared(self):
        words, _, _ = lines("uniform-1k", 2, contestant(OURS, [1.0, 2.0], megabytes=20), contestant("CDT", [4.0, 4.0]))
        self.assertNotIn("peak memory", words)

    def test_sums_over_structures_are_paired_by_round(self):
        each = [
            contests.Contest("a", 10, [contestant(OURS, [1.0, 3.0]), contestant(peers3.CGAL, [2.0, 3.0])], dims=3),
            contests.Contest("b", 10, [contestant(OURS, [1.0, 1.0]), contestant(peers3.CGAL, [4.0, 3.0])], dims=3),
            contests.Contest("c", 10, [contestant(OURS, [9.0, 9.0])], dims=3),
        ]
        self.assertEqual(tables.ratio_of_sums(each, peers3.CGAL, OURS).rounds, {1: 3.0, 2: 1.5})
        self.assertIn("2.25 (1.50 to 3.00)", tables.structures(each, {}))
        (ratio,) = tables.sums_as_json(each)["ratios"]
        self.assertEqual((ratio["under"], ratio["rounds"]), (OURS, {1: 3.0, 2: 1.5}))


if __name__ == "__main__":
    unittest.main()
