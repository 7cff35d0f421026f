"""Pins programs to cores, so that the system does not move them, where it allows this."""

import contextlib
import os
import pathlib

SIBLINGS = "/sys/devices/system/cpu/cpu{}/topology/thread_siblings_list"


class Pins:
    """Cores for programs of some number of threads."""

    def __init__(self, is_wanted=True):
        self.cores, self.reason = [], "not wanted"
        if is_wanted:
            self.cores, self.reason = allowed()

    def of(self, threads):
        """The cores for a number of threads; 0 stands for programs that use all of them."""
        return set(self.cores[:threads] if threads else self.cores)

    @contextlib.contextmanager
    def held(self, threads):
        """Processes that are started meanwhile inherit the cores."""
        if not self.cores:
            yield
            return
        before = os.sched_getaffinity(0)
        os.sched_setaffinity(0, self.of(threads))
        try:
            yield
        finally:
            os.sched_setaffinity(0, before)

    def __str__(self):
        if not self.cores:
            return f"no: {self.reason}"
        two = ", ".join(map(str, sorted(self.of(2))))
        return f"yes: one thread to core {self.cores[0]}, two to {two}, whole pipes to all {len(self.cores)}"


def allowed():
    """The cores that this process may use, the best first, and why there are none."""
    try:
        cores = os.sched_getaffinity(0)
        os.sched_setaffinity(0, cores)
    except (AttributeError, OSError) as error:
        return [], f"not allowed: {error}"
    return preferred(cores, {core: siblings(core) for core in cores}), ""


def preferred(cores, siblings):
    """One thread of each physical core first, and the last cores before the first ones, which serve interrupts."""
    return sorted(cores, key=lambda core: (sorted(siblings[core] & set(cores)).index(core), -core))


def siblings(core):
    """The hardware threads of the physical core of `core`."""
    try:
        return {core, *numbers(pathlib.Path(SIBLINGS.format(core)).read_text())}
    except OSError:
        return {core}


def numbers(text):
    """The numbers of a list such as 0,4-6."""
    for part in text.strip().split(","):
        first, _, last = part.partition("-")
        yield from range(int(first), int(last or first) + 1)
