"""Inputs that are cut, damaged, grown or replaced, before a run and while it reads."""

import os
import time

import inputs
import verdicts
from cases import Expected, Plan, Skip, fault, first_failed

# Formats that say where they end, by the ends of names. Of others no program can tell that something is
# missing.
ENDED = (".spm", ".las", ".laz", ".gz", ".nrrd", ".json", ".geojson", ".gpkg")
# Formats with a checksum for every byte.
CHECKED = (".spm", ".gz")


def reads(job, stage):
    return bool(job.inputs(stage)) or stage > 0


def reads_files(job, stage):
    return any(name != "-" for name in job.inputs(stage))


def choose(case, endings=None, can_be_part=True, is_own=False):
    """One of the files that the program reads; if `is_own`, one that no other program of the pipe reads."""
    names = [name for name in case.job.inputs(case.stage) if name not in ("-", "parts")]
    if can_be_part and "parts" in case.job.needs and case.numbers.random() < 0.7:
        folder = case.world.folder / "in" / "parts"
        names = [f"parts/{path.relative_to(folder)}" for path in sorted(folder.glob("*/*.spm"))]
    names = [name for name in names if endings is None or name.endswith(endings)]
    if is_own:
        read = [name for stage in range(len(case.job.stages)) for name in case.job.inputs(stage)]
        names = [name for name in names if read.count(name) == 1]
    if not names:
        raise Skip("reads no such file")
    return case.numbers.choice(names)


def repairs(case):
    """Whether the program may make a damaged part again, or need not read it."""
    return case.job.name == "collect"


def with_file(case, name, data, codes, cause, what, out_is_checked=True):
    """Runs the job with other bytes in a file."""
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    path = room.inputs / name
    times = os.stat(path)
    path.write_bytes(data)
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
    room.disturbed.add(name.split("/")[0])
    outcome = case.run(room, Plan(), is_to_file)
    if case.job.name == "sweep":
        # What is wrong about one file of a sweep.
        codes = [*codes, 1]
    # Other programs of the pipe may read the same file.
    expected = Expected(first_failed(outcome, case.stage), codes, [whole], cause)
    case.judge(outcome, expected, room, what, out_is_checked=out_is_checked or any(outcome.codes))


@fault("cut", reads_files)
def cut(case):
    """A file of which the end is missing."""
    name = choose(case)
    data = (case.world.folder / "in" / name).read_bytes()
    length = case.numbers.choice(
        [len(data) - 1, case.numbers.randrange(1, len(data)), case.numbers.randrange(len(data))]
    )
    is_ended = name.endswith(ENDED) and length > 0
    # JSON without its last line end is whole.
    is_whole = name.endswith("json") and not data[length:].strip()
    codes = [3] if is_ended and not is_whole and not repairs(case) else [0, 2, 3]
    if case.job.name in ("nodes", "listed"):
        # Of inputs that changed since the plan was made.
        codes = [*codes, 2]
    case_name = os.path.basename(name)
    with_file(
        case,
        name,
        data[:length],
        codes,
        ".",
        f"{case_name} cut after {length} of {len(data)} bytes",
        out_is_checked=is_ended,
    )


@fault("damaged", reads_files)
def damaged(case):
    """A file of which a bit is wrong."""
    name = choose(case, CHECKED)
    data = bytearray((case.world.folder / "in" / name).read_bytes())
    place = case.numbers.randrange(len(data))
    if name.endswith(".gz"):
        # Fields of the header, such as the time, do not count.
        place = max(place, 10)
    data[place] ^= 1 << case.numbers.randrange(8)
    codes = [0, 3] if repairs(case) else [2, 3, 6]
    with_file(case, name, bytes(data), codes, ".", f"{name} with another bit in byte {place}")


@fault("grown", reads_files)
def grown(case):
    """A file with something behind its end."""
    name = choose(case, ENDED)
    data = (case.world.folder / "in" / name).read_bytes()
    more = case.numbers.choice([b"\0", b"\n", b"more\n" * 100, data, case.numbers.randbytes(1000)])
    if name.endswith(".gz") and more == data:
        raise Skip("two compressed files are one")
    codes = [0, 2, 3, 6]
    with_file(case, name, data + more, codes, ".", f"{name} with {len(more)} bytes more")


@fault("cut-pipe", lambda job, stage: stage > 0)
def cut_pipe(case):
    """The pipe ends amid a stream, as when the program before was on another machine."""
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    length = case.numbers.choice([0, 1, 50, case.numbers.randrange(20_000), case.numbers.randrange(200_000)])
    passed = []

    def sizes():
        left = length
        while left > 0:
            passed.append(min(left, 4096))
            yield passed[-1], 0
            left -= passed[-1]

    outcome = case.run(room, Plan(relays={case.stage: sizes()}), is_to_file)
    case.judge(
        outcome, Expected(case.stage, [0, 3], [whole], "stdin"), room, f"the pipe ends after {length} bytes"
    )


def while_read(case, change, what, more_wholes):
    """Changes a file at a random moment of the run."""
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    wholes = [whole, *more_wholes(is_to_file)]
    at = case.numbers.random() * whole.seconds

    def during(stages, seconds):
        if seconds < at:
            return False
        change(room)
        return True

    outcome = case.run(room, Plan(during=during), is_to_file)
    # An audit finds that the points of a mesh are not those of the file.
    codes = [0, 1, 2, 3, 4] if "spinfo" in case.job.tools else [0, 1, 2, 3]
    expected = Expected(first_failed(outcome, case.stage), codes, wholes)
    case.judge(outcome, expected, room, f"{what} after {at:.4f} s", is_hit=True)


def other_whole(case, change):
    """Runs the job on files that were changed from the start; what it writes is right, too."""

    def run(is_to_file):
        room = case.room(has_old=False, is_to_file=is_to_file)
        change(room)
        outcome = case.run(room, Plan(), is_to_file)
        return [verdicts.Whole(outcome)] if not any(outcome.codes) else []

    return run


def disturb(room, name):
    """Notes that the fault changes an input. For another plan, a program makes other parts."""
    room.disturbed |= {name, "parts"} if name == "plan.json" else {name}


@fault("replaced", reads_files)
def replaced(case):
    """Another file takes the name of the input while the program reads."""
    name = choose(case, can_be_part=False)

    def change(room):
        disturb(room, name)
        inputs.replace(case.world.folder / "other" / "in" / name, room.inputs / name)

    while_read(case, change, f"{name} is replaced", other_whole(case, change))


@fault("overwritten", reads_files)
def overwritten(case):
    """Another file is copied over the input while the program reads."""
    name = choose(case, can_be_part=False)
    data = (case.world.folder / "other" / "in" / name).read_bytes()
    pause = case.numbers.choice([0, 0.002])

    def change(room):
        disturb(room, name)
        with open(room.inputs / name, "wb", buffering=0) as file:
            for start in range(0, len(data), len(data) // 4 + 1):
                file.write(data[start : start + len(data) // 4 + 1])
                time.sleep(pause)

    while_read(case, change, f"{name} is overwritten", other_whole(case, change))


@fault("growing", reads_files)
def growing(case):
    """Lines are appended to a text, or bytes to another file, while the program reads."""
    name = choose(case, can_be_part=False)
    data = (case.world.folder / "in" / name).read_bytes()
    more = (
        case.numbers.randbytes(1000)
        if name.endswith(ENDED)
        else b"".join(data.splitlines(keepends=True)[-50:])
    )

    def change(room):
        room.disturbed.add(name)
        with open(room.inputs / name, "ab") as file:
            file.write(more)

    while_read(case, change, f"{name} grows by {len(more)} bytes", other_whole(case, change))


@fault("shortened", reads_files)
def shortened(case):
    """The input loses its end while the program reads."""
    name = choose(case, ENDED, can_be_part=False)
    data = (case.world.folder / "in" / name).read_bytes()
    length = case.numbers.randrange(len(data))

    def change(room):
        room.disturbed.add(name)
        os.truncate(room.inputs / name, length)

    while_read(case, change, f"{name} is cut after {length} bytes", lambda is_to_file: [])
