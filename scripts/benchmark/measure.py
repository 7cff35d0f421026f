"""Runs programs, alone or in interleaved rounds, and measures wall time, CPU time and peak memory."""

import contextlib
import fcntl
import json
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field

# A program that takes longer is run once: more rounds serve to tell differences of a few per cent.
ONCE_SECONDS = 30.0


@dataclass
class Run:
    """The measurements of one run of a pipeline."""

    wall: float
    cpu: float
    # Peak resident memory of each process, in bytes; see floor_bytes.
    peaks: list
    # The lines of JSON that the processes wrote, as one object.
    said: dict
    failure: str = ""


@dataclass
class Contestant:
    """A pipeline to be timed. `commands` are argument lists, joined by pipes; `output` is a file or a folder
    that is removed after each run."""

    name: str
    commands: list
    output: str = ""
    # Exit codes that do not count as failures.
    accepts: tuple = (0,)
    runs: list = field(default_factory=list)
    failure: str = ""

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
        runs = [{"wall_s": r.wall, "cpu_s": r.cpu, "peak_bytes": r.peaks, "said": r.said} for r in self.runs]
        return {"name": self.name, "commands": self.commands, "failure": self.failure, "runs": runs}


def floor_bytes():
    """A lower limit of measured peaks: a new process is a copy of this one until it runs its program, and the
    system counts that."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def run(commands, limit_s, accepts=(0,)):
    """Runs `commands` as a pipeline, and kills it after `limit_s` seconds."""
    with tempfile.TemporaryFile("w+") as texts:
        start = time.perf_counter()
        processes = spawn([[str(word) for word in command] for command in commands], texts)
        overdue = threading.Event()
        timer = threading.Timer(limit_s, lambda: (overdue.set(), [p.kill() for p in processes]))
        timer.start()
        usages = []
        for process in processes:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            usages.append(usage)
        wall = time.perf_counter() - start
        timer.cancel()
        texts.seek(0)
        said, words = parse(texts.read())
    failed = [p.args[0] for p in processes if p.returncode not in accepts]
    failure = f"over {limit_s:.0f} s" if overdue.is_set() else f"{failed} failed: {words[-300:]}" if failed else ""
    cpu = sum(u.ru_utime + u.ru_stime for u in usages)
    return Run(wall, cpu, [u.ru_maxrss * 1024 for u in usages], said, failure)


def spawn(commands, texts):
    """Starts a pipeline; stderr of all processes and stdout of the last one go to `texts`."""
    processes = []
    source = subprocess.DEVNULL
    for number, command in enumerate(commands):
        is_last = number == len(commands) - 1
        sink = texts if is_last else subprocess.PIPE
        processes.append(subprocess.Popen(command, stdin=source, stdout=sink, stderr=texts))
        if number:
            source.close()
        source = processes[-1].stdout
    return processes


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


def compete(contestants, rounds, limit_s, lock=None):
    """Runs all contestants in turn, once per round, until each has its rounds, is too slow or fails."""
    for number in range(rounds):
        for contestant in contestants:
            slow = contestant.runs and contestant.runs[0].wall > ONCE_SECONDS and len(contestants) > 1
            if contestant.failure or slow:
                continue
            with alone(lock):
                result = run(contestant.commands, limit_s, contestant.accepts)
            remove(contestant.output)
            # Flush the output to disk now, so that the next contestant does not wait for it.
            os.sync()
            told = result.failure or f"{result.wall:.2f} s"
            print(f"  round {number + 1}: {contestant.name}: {told}", file=sys.stderr, flush=True)
            if result.failure:
                contestant.failure = result.failure
            else:
                contestant.runs.append(result)
