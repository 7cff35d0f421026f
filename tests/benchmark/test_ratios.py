"""Levels against counting, coverage against simulation with skewed noise, and faults that these checks find."""

import itertools
import math
import random
import statistics
import unittest

import ratios

TRIALS = 4000
SEED = 20261126


def exponential(draw):
    """Times of a program on a busy machine: seldom faster, sometimes much slower."""
    return 1 + draw.expovariate(4)


def pareto(draw):
    """Without a variance."""
    return draw.paretovariate(1.5)


def stepped(draw):
    """Two speeds, as of a core that changes its frequency, with a little noise."""
    return draw.choice((1.0, 1.0, 1.6)) + 1e-3 * draw.random()


def measured(noise, truth, count, draw):
    """Ratios of two programs whose noise has one distribution, so that the median ratio is `truth`. The speed of
    the machine drifts from round to round."""
    rounds = range(1, count + 1)
    speeds = {number: 2.0 ** draw.uniform(-1, 1) for number in rounds}
    over, under = ({number: speeds[number] * noise(draw) for number in rounds} for _ in range(2))
    return ratios.ratio({number: truth * time for number, time in over.items()}, under)


def coverage(noise, count, interval):
    """The share of trials in which an interval holds the true median."""
    draw, truth, held = random.Random(SEED), 1.3, 0
    for _ in range(TRIALS):
        found = interval(list(measured(noise, truth, count, draw).rounds.values()))
        held += found.low <= truth <= found.high
    return held / TRIALS


def is_as_stated(share, level):
    """Whether a share is within four standard deviations of a level."""
    return abs(share - level) < 4 * math.sqrt(level * (1 - level) / TRIALS)


def too_tight(values):
    """A fault: both ends one rank further in, at the level of the right ones."""
    right = ratios.interval(values)
    at = ratios.rank(len(values))
    inner = sorted(values)[at:-at]
    return ratios.Interval(inner[0], inner[-1], right.level)


def normal(values):
    """Another fault: the mean and its standard error, as if noise were normal."""
    mean, error = statistics.mean(values), statistics.stdev(values) / math.sqrt(len(values))
    return ratios.Interval(mean - 1.96 * error, mean + 1.96 * error, 0.95)


class Levels(unittest.TestCase):
    def test_levels_are_exact(self):
        self.assertEqual([ratios.level(count, 1) for count in (2, 5, 6, 7)], [0.5, 0.9375, 0.96875, 0.984375])
        self.assertEqual(ratios.percent(0.9375), "93.75 %")
        self.assertEqual(ratios.percent(0.984375), "98.4375 %")

    def test_levels_count_the_sides_of_the_median(self):
        for count in range(2, 11):
            sides = list(itertools.product((0, 1), repeat=count))
            for rank in range(1, count // 2 + 1):
                held = sum(sum(side) >= rank and count - sum(side) >= rank for side in sides)
                self.assertEqual(ratios.level(count, rank), held / len(sides))

    def test_ranks_are_the_tightest_with_the_level(self):
        for count in range(2, 60):
            rank = ratios.rank(count)
            self.assertTrue(rank == 1 or ratios.level(count, rank) >= ratios.LEVEL)
            self.assertTrue(rank == count // 2 or ratios.level(count, rank + 1) < ratios.LEVEL)

    def test_intervals_are_order_statistics(self):
        values = [5, 1, 4, 2, 3, 9, 8, 7, 6]
        self.assertEqual(ratios.interval(values), ratios.Interval(2, 8, ratios.level(9, 2)))
        self.assertEqual(ratios.interval(values[:5]), ratios.Interval(1, 5, 0.9375))
        self.assertIsNone(ratios.interval([1.0]))

    def test_the_interval_of_inverse_ratios_is_the_inverse_interval(self):
        draw = random.Random(SEED)
        for count in range(2, 20):
            values = [2.0 ** draw.randrange(-8, 8) for _ in range(count)]
            there, back = ratios.interval(values), ratios.interval([1 / value for value in values])
            self.assertEqual((there.low, there.high, there.level), (1 / back.high, 1 / back.low, back.level))


class Coverage(unittest.TestCase):
    def test_intervals_hold_the_median_as_often_as_stated(self):
        for noise, count in itertools.product((exponential, pareto, stepped), (3, 5, 7, 8, 13, 20)):
            level = ratios.level(count, ratios.rank(count))
            share = coverage(noise, count, ratios.interval)
            self.assertTrue(is_as_stated(share, level), f"{noise.__name__}, {count}: {share} of {level}")

    def test_planted_faults_are_found(self):
        for count in (7, 20):
            level = ratios.level(count, ratios.rank(count))
            self.assertFalse(is_as_stated(coverage(exponential, count, too_tight), level))
        self.assertFalse(is_as_stated(coverage(pareto, 20, normal), 0.95))

    def test_equal_programs_are_seldom_told_apart_and_slower_ones_often(self):
        draw = random.Random(SEED)
        equal = [measured(exponential, 1.0, 7, draw).is_distinct for _ in range(TRIALS)]
        self.assertTrue(is_as_stated(1 - sum(equal) / TRIALS, ratios.level(7, 1)))
        slower = [measured(exponential, 2.0, 7, draw).is_distinct for _ in range(TRIALS)]
        self.assertGreater(sum(slower) / TRIALS, 0.9)

    def test_drift_does_not_hide_a_difference(self):
        """Programs that differ by 5 % on a machine whose speed changes fourfold."""
        draw = random.Random(SEED)
        ratio = measured(lambda draw: 1 + 0.01 * draw.random(), 1.05, 7, draw)
        self.assertTrue(ratio.is_distinct)
        self.assertAlmostEqual(ratio.median, 1.05, delta=0.01)


class Ratios(unittest.TestCase):
    def test_rounds_are_paired_by_their_number(self):
        ratio = ratios.ratio({1: 2.0, 2: 9.0, 3: 8.0}, {1: 1.0, 3: 2.0, 4: 5.0})
        self.assertEqual(ratio.rounds, {1: 2.0, 3: 4.0})
        self.assertEqual(ratio.median, 3.0)

    def test_a_program_that_runs_once_has_no_interval(self):
        ratio = ratios.ratio({0: 30.0}, {1: 9.0, 2: 10.0, 3: 12.0})
        self.assertEqual((ratio.rounds, ratio.median, ratio.interval), ({}, 3.0, None))
        self.assertEqual(str(ratio), "3.00 (no interval)")
        self.assertIsNone(ratios.ratio({}, {1: 1.0}))

    def test_an_interval_with_1_is_said_to_tell_nothing(self):
        same = ratios.ratio({1: 9.0, 2: 11.0, 3: 10.0}, dict.fromkeys((1, 2, 3), 10.0))
        self.assertEqual(str(same), "1.00 (0.900 to 1.10), not distinguishable")
        other = ratios.ratio({1: 9.0, 2: 8.0, 3: 7.0}, dict.fromkeys((1, 2, 3), 10.0))
        self.assertEqual(str(other), "0.800 (0.700 to 0.900)")
        touching = ratios.ratio({1: 10.0, 2: 12.0}, dict.fromkeys((1, 2), 10.0))
        self.assertFalse(touching.is_distinct)

    def test_json_has_every_round_and_the_level(self):
        facts = ratios.ratio({1: 2.0, 2: 3.0}, {1: 1.0, 2: 1.0}).as_json()
        self.assertEqual(facts["rounds"], {1: 2.0, 2: 3.0})
        self.assertEqual((facts["low"], facts["high"], facts["level"]), (2.0, 3.0, 0.5))


class Orders(unittest.TestCase):
    def test_each_place_and_each_neighbour_comes_equally_often(self):
        for count in range(1, 14):
            turn = count if count % 2 == 0 else 2 * count
            rows = list(itertools.islice(ratios.orders(count, SEED), turn))
            self.assertTrue(all(sorted(row) == list(range(count)) for row in rows))
            for place in range(count):
                self.assertEqual({sum(row[place] == name for row in rows) for name in range(count)}, {turn // count})
            pairs = [pair for row in rows for pair in itertools.pairwise(row)]
            often = {pairs.count(pair) for pair in itertools.permutations(range(count), 2)}
            self.assertLessEqual(often, {turn // count})

    def test_orders_follow_from_the_seed(self):
        first = [list(itertools.islice(ratios.orders(9, seed), 3)) for seed in (1, 1, 2)]
        self.assertEqual(first[0], first[1])
        self.assertNotEqual(first[0], first[2])


if __name__ == "__main__":
    unittest.main()
