"""Runs programs, alone or in interleaved rounds, and measures wall time, CPU time and peak memory."""

import contextlib
import fcntl
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field

import disk
import ratios

# A program that takes longer is run once: more rounds serve to tell differences of a few per cent.
ONCE_SECONDS = 30.0
# The system counts the peak of a process that waits in vfork, which is this one's, as that of the new program.
# After fork it counts only what this process holds at the time.
subprocess._USE_VFORK = False


@dataclass
class Run:
    """The measurements of one run of a pipeline."""

    wall: float
    # Seconds of the processor, of each process.
    cpus: list
    # Peak resident memory of each process, in bytes; see floor_bytes.
    peaks: list
    # The lines of JSON that the processes wrote, as one object.
    said: dict
    failure: str = ""
    # Peak of temporary files, in bytes, if it was sampled.
    disk: int = 0
    # From 1; 0 is the warm-up, which counts only for programs that are run once.
    round: int = 0
    # What floor_bytes was at the time.
    floor: int = 0

    @property
    def cpu(self):
        return sum(self.cpus)

    @property
    def memory(self):
        """Peak memory of all processes together; None near the floor, where a peak may not be the program's."""
        return sum(self.peaks) if min(self.peaks) > 1.1 * self.floor else None

    def as_json(self):
        times = {"round": self.round, "wall_s": self.wall, "cpus_s": self.cpus}
        return {**times, "peak_bytes": self.peaks, "disk_bytes": self.disk, "said": self.said}


@dataclass
class Contestant:
    """A pipeline to be timed. `commands` are argument lists, joined by pipes; `output` is a file or a folder
    that is removed after each run."""

    name: str
    commands: list
    output: str = ""
    # How many cores the pipeline may use; 0 stands for all.
    threads: int = 1
    # An empty folder for temporary files, whose size is sampled.
    temporary: str = ""
    # Exit codes that do not count as failures.
    accepts: tuple = (0,)
    runs: list = field(default_factory=list)
    failure: str = ""

    def by_round(self, value):
        """The values of all runs that have one, by round."""
        values = {run.round: value(run) for run in self.runs}
        return {number: v for number, v in values.items() if v is not None}

    def median(self, value):
        """Median of `value` over the runs; None if no run has a value."""
        values = [v for v in map(value, self.runs) if v is not None]
        return statistics.median(values) if values else None

    @property
    def wall(self):
        return self.median(lambda run: run.wall)

    @property
    def cpu(self):
        return self.median(lambda run: run.cpu)

    @property
    def peaks(self):
        """The highest peak of each process over all runs."""
        return [max(peaks) for peaks in zip(*(run.peaks for run in self.runs))]

    def said(self, key):
        return self.median(lambda run: run.said.get(key))

    def as_json(self):
        runs = [run.as_json() for run in self.runs]
        return {"name": self.name, "commands": self.commands, "failure": self.failure, "runs": runs}


def floor_bytes():
    """A lower limit of measured peaks, that of a program that does nothing: a new process is a copy of this one
    until it runs its program, and the system counts that."""
    return reap(subprocess.Popen(["true"])).ru_maxrss * 1024


def run(contestant, limit_s, pins=None):
    """Runs a pipeline, and kills it after `limit_s` seconds."""
    with tempfile.TemporaryFile("w+") as texts:
        start = time.perf_counter()
        with pins.held(contestant.threads) if pins else contextlib.nullcontext():
            processes = spawn(contestant, texts)
        overdue = threading.Event()
        timer = threading.Timer(limit_s, lambda: (overdue.set(), [p.kill() for p in processes]))
        timer.start()
        with sampler(contestant, processes) as sampled:
            usages = [reap(process) for process in processes]
        wall = time.perf_counter() - start
        timer.cancel()
        texts.seek(0)
        said, words = parse(texts.read())
    failed = [p.args[0] for p in processes if p.returncode not in contestant.accepts]
    failure = f"over {limit_s:.0f} s" if overdue.is_set() else f"{failed} failed: {words[-300:]}" if failed else ""
    cpus = [u.ru_utime + u.ru_stime for u in usages]
    peaks = [usage.ru_maxrss * 1024 for usage in usages]
    return Run(wall, cpus, peaks, said, failure, sampled.peak if sampled else 0, floor=floor_bytes())


def spawn(contestant, texts):
    """Starts a pipeline; stderr of all processes and stdout of the last one go to `texts`."""
    processes = []
    source = subprocess.DEVNULL
    folder = {"TMPDIR": str(contestant.temporary)} if contestant.temporary else {}
    for number, command in enumerate(contestant.commands):
        words = [str(word) for word in command]
        is_last = number == len(contestant.commands) - 1
        sink = texts if is_last else subprocess.PIPE
        environment = {**os.environ, **folder}
        processes.append(subprocess.Popen(words, stdin=source, stdout=sink, stderr=texts, env=environment))
        if number:
            source.close()
        source = processes[-1].stdout
    return processes


def sampler(contestant, processes):
    if not contestant.temporary:
        return contextlib.nullcontext()
    return disk.Sampler(contestant.temporary, [process.pid for process in processes])


def reap(process):
    """Waits for a process; returns what it used."""
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return usage


def parse(text):
    """The JSON objects in `text`, merged, and the other lines."""
    said, words = {}, []
    for line in text.splitlines():
        if line.startswith("{"):
            said.update(json.loads(line))
        else:
            words.append(line)
    return said, " ".join(words)


def remove(output):
    if output and os.path.isdir(output):
        shutil.rmtree(output)
    elif output and os.path.exists(output):
        os.remove(output)


@contextlib.contextmanager
def alone(path):
    """Holds a lock if a path is given, so that other jobs on this machine can wait for it."""
    if not path:
        yield
        return
    with open(path, "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def compete(contestants, flags, limit_s):
    """Runs all contestants once as a warm-up, which is not counted, and then once per round, in an order that
    changes. One that is too slow or fails is not run again. The warm-up of one that takes over ONCE_SECONDS is
    its only run, unless it is alone."""
    orders = ratios.orders(len(contestants), flags.seed)
    for number in range(flags.rounds + 1):
        for place in next(orders):
            contestant = contestants[place]
            if contestant.failure or (contestant.runs and contestant.runs[0].round == 0):
                continue
            with alone(flags.lock):
                result = run(contestant, limit_s, flags.pins)
            result.round = number
            remove(contestant.output)
            # Flush the output to disk now, so that the next contestant does not wait for it.
            os.sync()
            told = result.failure or f"{result.wall:.2f} s"
            print(f"  {name_of(number)}: {contestant.name}: {told}", file=sys.stderr, flush=True)
            contestant.failure = result.failure
            if not result.failure and (number or (result.wall > ONCE_SECONDS and len(contestants) > 1)):
                contestant.runs.append(result)


def name_of(number):
    return f"round {number}" if number else "warm-up"
