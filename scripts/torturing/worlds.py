"""What the cases of a seed share: inputs, and what each job writes when nothing disturbs it."""

import os
import resource
import subprocess

import inputs
import runs
import users
import verdicts
from cases import World, commands
from jobs import JOBS

MIB = 1 << 20


class Unsound(Exception):
    """The cases cannot be run."""


def least_space(program):
    """Least address space in which a program says its version, in bytes."""
    low, high = 1, 512
    while low < high:
        middle = (low + high) // 2
        limit = middle * MIB
        done = subprocess.run(
            [program, "--version"],
            capture_output=True,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
        )
        low, high = (low, middle) if done.returncode == 0 else (middle + 1, high)
    return high * MIB


def make(programs, folder, seed, count, jobs, can_mount):
    """The world of a seed: inputs of some `count` points, and undisturbed runs of all jobs."""
    missing = [tool for job in JOBS for tool in job.tools if not os.access(f"{programs}/{tool}", os.X_OK)]
    if missing:
        raise Unsound(
            f"{programs} has no {missing[0]}: build the programs, or name their folder with --programs"
        )
    inputs.make(folder, programs, seed, count)
    inputs.make(folder / "other", programs, f"{seed} other", count * 3 // 4)
    os.chmod(folder, 0o755)
    tools = {tool for job in jobs for tool in job.tools}
    spaces = {tool: least_space(f"{programs}/{tool}") for tool in tools}
    user = users.find(f"{programs}/spinfo")
    world = World(programs, folder, inputs.nodes(programs, folder), {}, can_mount, user, spaces)
    add_wholes(world, jobs)
    return world


def add_wholes(world, jobs):
    """Runs all jobs undisturbed."""
    for job in jobs:
        for is_to_file in (True, False):
            if not (job.is_to_stdout_only if is_to_file else job.is_to_file_only):
                world.wholes[job.name, is_to_file] = whole(world, job, is_to_file)


def whole(world, job, is_to_file):
    """An undisturbed run. Two of them must be the same."""
    found = []
    for number in range(2):
        room = runs.Room(world.folder / f"whole-{number}", world.folder / "in", job)
        outcome = runs.run(room, job, commands(job, is_to_file, world.nodes), world.programs, runs.Plan())
        room.close()
        if any(outcome.codes) or "".join(outcome.messages):
            raise Unsound(f"{job.name} fails undisturbed: {outcome.codes}: {''.join(outcome.messages)}")
        found.append(verdicts.Whole(outcome))
    if (found[0].files, found[0].stdout) != (found[1].files, found[1].stdout):
        raise Unsound(f"two undisturbed runs of {job.name} differ")
    return found[1]
