"""Named pipes, and outputs that are inputs."""

import errno
import os
import threading
import time

import runs
from cases import Expected, Plan, Skip, fault, last
from faults_inputs import choose, reads_files

# Programs that take several files of points.
TAKES_MANY = {"spfinalize", "spground", "spheight", "spcanopy", "configgen"}


def fill(path, data, is_over):
    """Writes bytes to a named pipe once, as soon as a program opens it."""
    while not is_over.is_set():
        try:
            target = os.open(path, os.O_WRONLY | os.O_NONBLOCK)
        except OSError as error:
            if error.errno not in (errno.ENXIO, errno.ENOENT):
                raise
            time.sleep(0.002)
            continue
        os.set_blocking(target, True)
        runs.feed(target, data, None)
        return


def make_pipe(room, name):
    path = room.inputs / name
    data = path.read_bytes()
    path.unlink()
    os.mkfifo(path)
    room.disturbed.add(name)
    return path, data


def with_pipe(case, prepare, codes, what):
    """Runs the job with an input that is a named pipe."""
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    path, data = prepare(room)
    is_over = threading.Event()
    plan = Plan(beside=[lambda: fill(path, data, is_over)], after=is_over.set)
    outcome = case.run(room, plan, is_to_file)
    case.judge(outcome, Expected(case.stage, codes, [whole]), room, what, is_hit=True)


@fault("fifo", reads_files)
def fifo(case):
    """A named pipe instead of a file: right, or a clear error."""
    name = choose(case, can_be_part=False, is_own=True)

    def prepare(room):
        return make_pipe(room, name)

    # A file that is read twice is empty the second time.
    with_pipe(case, prepare, [0, 1, 2, 3], f"{name} is a named pipe")


@fault("fifo-twice", reads_files)
def fifo_twice(case):
    """One named pipe under two names, or twice under one: a clear error, or right."""
    names = [name for name in case.job.inputs(case.stage) if name not in ("-", "parts")]
    if len(names) > 1:
        first, second = case.numbers.sample(names, 2)
    elif names and case.tool in TAKES_MANY and "--ground" not in case.job.pipe:
        first, second = names[0], None
    else:
        raise Skip("reads one file")

    def prepare(room):
        path, data = make_pipe(room, first)
        if second:
            (room.inputs / second).unlink()
            os.symlink(first, room.inputs / second)
            room.disturbed.add(second)
        return path, data

    if second is None:
        case = Doubled(case, f"in/{first}")
    with_pipe(case, prepare, [0, 1, 2, 3], f"{first} and {second or first} are one named pipe")


class Doubled:
    """A case whose programs get an argument twice."""

    def __init__(self, case, argument):
        self.case, self.argument = case, argument

    def __getattr__(self, name):
        return getattr(self.case, name)

    def run(self, room, plan, is_to_file):
        chosen = self.case.commands(is_to_file)
        chosen[self.case.stage].append(self.argument)
        self.case.result.runs += 1
        return runs.run(room, self.case.job, chosen, self.case.world.programs, plan)


@fault("fifo-out", last)
def fifo_out(case):
    """The output is a named pipe: the reader gets a whole output, or there is a clear error."""
    names = case.job.outputs()
    if not names:
        raise Skip("writes no file of a fixed name")
    chosen = case.numbers.choice(names)
    room = case.room(has_old=False)
    os.mkfifo(room.folder / chosen)
    source = os.open(room.folder / chosen, os.O_RDONLY | os.O_NONBLOCK)
    os.set_blocking(source, True)
    # Until the end of the program there is a writer, so that the reader waits.
    keeper = os.open(room.folder / chosen, os.O_WRONLY)
    got = []
    plan = Plan(beside=[lambda: got.append(runs.read_all(source))], after=lambda: os.close(keeper))
    outcome = case.run(room, plan)
    if outcome.codes[case.stage] == 0:
        name = chosen.removeprefix("out/")
        outcome.files[name] = runs.without_folder(room, name, b"".join(got))
    expected = Expected(case.stage, [0, 1, 2], [case.whole(True)])
    case.judge(outcome, expected, room, f"{chosen} is a named pipe", is_hit=True)


WAYS = ["path", "dot", "around", "hard link", "symbolic link", "linked folder"]


def way_to(room, name, output, way):
    """Another path to an input; links keep the ending of the output, which may choose the format."""
    target = room.inputs / name
    if way == "hard link":
        os.link(target, room.folder / output)
        return output
    if way == "symbolic link":
        os.symlink(os.path.relpath(target, (room.folder / output).parent), room.folder / output)
        return output
    if way == "linked folder":
        os.symlink("../in", room.out / "linked")
        return f"out/linked/{name}"
    return {"path": f"in/{name}", "dot": f"./in/./{name}", "around": f"out/../in/{name}"}[way]


@fault("same", lambda job, stage: last(job, stage) and reads_files(job, stage))
def same(case):
    """An output that is an input: it is refused, and the input stays."""
    outputs = case.job.outputs()
    if not outputs:
        raise Skip("writes no file of a fixed name")
    name, output = choose(case, can_be_part=False), case.numbers.choice(outputs)
    room, way = case.room(has_old=False), case.numbers.choice(WAYS)
    path = way_to(room, name, output, way)
    outcome = case.run(room, change=lambda argument: path if argument == output else argument)
    cause = "would replace the input" if "hard" in way or "symbolic" in way else "."
    case.judge(
        outcome,
        Expected(case.stage, [2], [], cause),
        room,
        f"output is the input {name}: {way}",
        out_is_checked=False,
    )


@fault("same-folder", lambda job, stage: job.name == "heights")
def same_folder(case):
    """Outputs that get the names of inputs."""
    room = case.room(has_old=False)
    room.out.rmdir()
    os.symlink("in", room.out)
    outcome = case.run(room)
    room.out.unlink()
    room.out.mkdir()
    case.judge(
        outcome,
        Expected(case.stage, [2], [], "would replace the input"),
        room,
        "outputs beside inputs",
        out_is_checked=False,
    )


@fault("same-stdin", lambda job, stage: stage == 0 and last(job, stage) and reads_files(job, stage))
def same_stdin(case):
    """The input comes through stdin, and is the output, too, by name or as stdout."""
    outputs = case.job.outputs()
    name = choose(case, can_be_part=False)
    by_name = case.job.is_to_file_only or bool(outputs) and case.numbers.random() < 0.5
    if by_name and not outputs:
        raise Skip("writes no file of a fixed name")
    room = case.room(has_old=False)
    path = room.inputs / name
    plan = Plan(stdin=os.open(path, os.O_RDONLY))
    if not by_name:
        # As in a shell `1<> input`; `> input` would have emptied it before.
        plan.stdout = os.open(path, os.O_RDWR)
    replaced = {f"in/{name}": "-"}
    if by_name:
        output = case.numbers.choice(outputs)
        os.link(path, room.folder / output)
    outcome = case.run(room, plan, by_name, change=lambda argument: replaced.get(argument, argument))
    reads_stdin = "stdin" in "".join(outcome.messages)
    expected = Expected(0, [2] if reads_stdin else [1, 2, 3], [], ".")
    case.judge(
        outcome,
        expected,
        room,
        f"stdin and {'output' if by_name else 'stdout'} are {name}",
        out_is_checked=False,
    )
