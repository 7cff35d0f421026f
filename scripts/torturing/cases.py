"""A case: one fault at one program of one job, with everything random drawn from the seed and the name."""

import dataclasses
import pathlib
import random
import tempfile

import runs
import verdicts
from runs import Plan, Room
from verdicts import Expected

FAULTS = {}


class Skip(Exception):
    """The fault does not concern the job, or cannot be made here."""


@dataclasses.dataclass(frozen=True)
class World:
    """What all cases of a round share."""

    programs: str
    # Folder with in/, and with folders for runs.
    folder: pathlib.Path
    nodes: str
    # Undisturbed runs by name of the job and whether it writes files.
    wholes: dict
    can_mount: bool
    # A user without rights who may run the programs, or None.
    user: int | None
    # Least address space in which each program says its version, in bytes.
    least_space: dict


@dataclasses.dataclass
class Result:
    """What a case found."""

    name: str
    tool: str
    fault: str
    runs: int = 0
    hits: int = 0
    complaints: list = dataclasses.field(default_factory=list)
    skipped: str = ""


def fault(name, applies=lambda job, stage: True):
    """Registers a fault: a function of a case."""

    def register(function):
        FAULTS[name] = (function, applies)
        return function

    return register


def last(job, stage):
    return job.is_last(stage)


def writes_stdout(job, stage):
    return not job.is_last(stage) or not job.is_to_file_only


class Case:
    def __init__(self, world, job, stage, name, seed):
        self.world, self.job, self.stage, self.fault, self.seed = world, job, stage, name, seed
        self.name = f"{job.name}.{stage}/{name}"
        self.tool = job.tools[stage]
        self.numbers = random.Random(f"{seed} {self.name}")
        self.result = Result(self.name, self.tool, name)
        self.rooms = []

    def torture(self):
        """Runs the fault; complaints are in the result."""
        try:
            FAULTS[self.fault][0](self)
        except Skip as reason:
            self.result.skipped = str(reason)
        except Exception as error:
            raise RuntimeError(f"the case {self.name} of seed {self.seed} could not be run") from error
        finally:
            for room in self.rooms:
                room.close()
        return self.result

    def room(self, has_old=None, is_to_file=True):
        """A fresh folder; by the seed with earlier files under the names of the outputs."""
        folder = tempfile.mkdtemp(prefix="run-", dir=self.world.folder)
        room = Room(pathlib.Path(folder) / "room", self.world.folder / "in", self.job)
        self.rooms.append(room)
        room.outer = pathlib.Path(folder)
        is_old = self.numbers.random() < 0.5 if has_old is None else has_old
        # Nodes that are there would not be made, and pyramids are refused.
        if is_old and is_to_file and "spnode" not in self.job.tools and self.job.name not in ("sweep", "tiles"):
            room.place_old(self.whole(True).files)
        return room

    def is_to_file(self):
        """Whether this run writes a file; by the seed, if the job can do both."""
        if self.job.is_to_file_only or self.job.is_to_stdout_only:
            return self.job.is_to_file_only
        return self.numbers.random() < 0.7

    def whole(self, is_to_file):
        return self.world.wholes[self.job.name, is_to_file]

    def commands(self, is_to_file):
        return commands(self.job, is_to_file, self.world.nodes)

    def run(self, room, plan=None, is_to_file=True, last_stage=None, change=None):
        """Runs the job, up to `last_stage`, with command lines that `change` may change."""
        chosen = self.commands(is_to_file)
        if last_stage is not None:
            chosen = chosen[: last_stage + 1]
        if change:
            chosen = [[change(argument) for argument in command] for command in chosen]
        self.result.runs += 1
        return runs.run(room, self.job, chosen, self.world.programs, plan or Plan())

    def judge(self, outcome, expected, room, what="", is_hit=None, out_is_checked=True):
        """Judges and remembers complaints. A hit is a fault that stopped a program."""
        found = verdicts.judge(outcome, expected, room.old, out_is_checked)
        found += [(verdicts.SILENT, f"in/{name}: the input was changed") for name in room.changed_inputs()]
        self.result.hits += any(outcome.codes) if is_hit is None else is_hit
        shown = " | ".join(" ".join(command) for command in outcome.commands)
        self.result.complaints += [
            (kind, f"{text}\n    {what + ': ' if what else ''}{shown}") for kind, text in found
        ]

    def complain(self, kind, text):
        self.result.complaints.append((kind, text))


def first_failed(outcome, default):
    """The first program that failed, but for those whose reader had gone."""
    return next((k for k, code in enumerate(outcome.codes) if code not in (0, verdicts.CLOSED_PIPE)), default)


def commands(job, is_to_file, nodes):
    chosen = []
    for command in job.commands(is_to_file):
        chosen.append([part for word in command for part in (nodes.split() if word == "{nodes}" else [word])])
    return chosen


__all__ = [
    "Case",
    "Expected",
    "FAULTS",
    "Plan",
    "Result",
    "Skip",
    "World",
    "fault",
    "first_failed",
    "last",
    "writes_stdout",
]
