"""Ratios of two programs from interleaved rounds, and how certain they are.

The speed of a machine drifts, but little within a round. So programs are compared within each round, and the
result is the median of these ratios. Its interval consists of two of the sorted ratios: it assumes that rounds
are independent, and nothing of the distribution of their noise. The number of values below the median has the
binomial distribution of fair coins, so the median of N rounds lies between the ratios of rank R and N + 1 - R
with the probability of R to N - R heads in N throws (David and Nagaraja, Order Statistics, 7.1).
"""

import math
import random
import statistics
from dataclasses import dataclass

LEVEL = 0.95
SAME = "not distinguishable"


def level(count, rank):
    """The probability that the median lies between the values of rank `rank` and `count + 1 - rank`, from 1."""
    return sum(math.comb(count, heads) for heads in range(rank, count - rank + 1)) / 2**count


def rank(count, wanted=LEVEL):
    """The greatest rank whose interval has the wanted level; 1, for least to greatest, if none has it. Both
    ends have the same rank, so that the interval of inverse ratios is the inverse interval."""
    return max((r for r in range(1, count // 2 + 1) if level(count, r) >= wanted), default=1)


@dataclass(frozen=True)
class Interval:
    """An interval of the median, in the order of the values, and its exact level."""

    low: float
    high: float
    level: float


def interval(values, wanted=LEVEL):
    """The tightest interval with the wanted level, or least to greatest; None of fewer than two values."""
    ordered, count = sorted(values), len(values)
    if count < 2:
        return None
    at = rank(count, wanted)
    return Interval(ordered[at - 1], ordered[count - at], level(count, at))


@dataclass(frozen=True)
class Ratio:
    """Ratios by round. A ratio without rounds is one of medians: a program ran once, in none of the rounds."""

    rounds: dict
    median: float

    @property
    def interval(self):
        return interval(list(self.rounds.values()))

    @property
    def is_distinct(self):
        """Whether the interval excludes 1; None without an interval."""
        found = self.interval
        return found and not found.low <= 1 <= found.high

    def __str__(self):
        """For a table: 2.77 (2.70 to 2.84)."""
        return self.told("")

    def told(self, words):
        """The median, its interval, and words after them: 2.77 (2.70 to 2.84) times as fast."""
        found = self.interval
        span = f"{digits(found.low)} to {digits(found.high)}" if found else "no interval"
        same = f", {SAME}" if found and not self.is_distinct else ""
        return f"{digits(self.median)} ({span}){words and ' '}{words}{same}"

    def as_json(self):
        found = self.interval
        bounds = {"low": found.low, "high": found.high, "level": found.level} if found else {}
        return {"median": self.median, **bounds, "is_distinct": self.is_distinct, "rounds": self.rounds}


def digits(value):
    return f"{value:.3f}" if value < 0.995 else f"{value:.2f}"


def ratio(over, under):
    """The ratio of two measurements, given by round; None if one of them is missing."""
    if not over or not under:
        return None
    rounds = {number: over[number] / under[number] for number in sorted(over.keys() & under.keys())}
    if rounds:
        return Ratio(rounds, statistics.median(rounds.values()))
    return Ratio({}, statistics.median(over.values()) / statistics.median(under.values()))


def percent(share):
    """A level, rounded down: 98.4375 %."""
    return f"{math.floor(share * 1e6) / 1e4:g} %"


def orders(count, seed):
    """The orders of contestants, round by round, without end: the rows of a Williams square of a shuffled
    start. In a turn of `count` rounds, or twice as many if `count` is odd, each contestant has each place
    equally often, and runs equally often after each other one."""
    names = list(range(count))
    random.Random(seed).shuffle(names)
    # 0, N-1, 1, N-2, ...: the steps between neighbours all differ, or with those of the reverse come twice each.
    zigzag = [i // 2 if i % 2 == 0 else count - 1 - i // 2 for i in range(count)]
    number = 0
    while True:
        shift, is_back = (number, False) if count % 2 == 0 else (number // 2, number % 2 == 1)
        row = [names[(place + shift) % count] for place in zigzag]
        yield row[::-1] if is_back else row
        number += 1
