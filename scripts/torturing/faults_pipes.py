"""Slow readers and writers, readers that go away, and standard streams that are closed."""

import os
import resource

from cases import Expected, Plan, Skip, fault, last, writes_stdout


def trickle(numbers):
    """Sizes of pieces and pauses before them: bytes one by one, then larger pieces, now and then a pause."""
    for _ in range(40):
        yield numbers.randrange(1, 6), numbers.choice([0, 0, 0.001, 0.003])
    while True:
        size = numbers.choice([1, 7, 100, 4_000, 20_000, 70_000])
        for _ in range(numbers.randrange(1, 30)):
            yield size, 0.001 if numbers.random() < 0.02 else 0


@fault("slow")
def slow(case):
    """Data come and go in small pieces, with pauses."""
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    relays = {k: trickle(case.numbers) for k in (case.stage, case.stage + 1) if k < len(case.job.stages)}

    def reader(source):
        parts = []
        for size, pause in trickle(case.numbers):
            part = os.read(source, size)
            if not part:
                break
            parts.append(part)
        os.close(source)
        return b"".join(parts)

    outcome = case.run(room, Plan(relays=relays, reader=reader), is_to_file)
    case.judge(outcome, Expected(case.stage, [0], [whole]), room, "slow neighbours", is_hit=True)


def reading(count):
    """A reader of so many bytes."""

    def reader(source):
        left, parts = count, []
        while left and (part := os.read(source, left)):
            parts.append(part)
            left -= len(part)
        os.close(source)
        return b"".join(parts)

    return reader


def names_files(case):
    """Whether the last program of the job, which does not run here, would write a file."""
    return not case.job.is_last(case.stage) and not case.job.is_to_stdout_only


@fault("reader-gone", writes_stdout)
def reader_gone(case):
    """The reader closes the pipe early: no message, and 141."""
    room, is_to_file = case.room(has_old=False), names_files(case)
    count = case.numbers.choice([1, 20, 100, case.numbers.randrange(1, 100_000)])
    outcome = case.run(room, Plan(reader=reading(count)), is_to_file, case.stage)
    # What was written may have been all.
    expected = Expected(case.stage, [0, 141], [case.whole(is_to_file)])
    case.judge(outcome, expected, room, f"a reader of {count} bytes", out_is_checked=False)
    check_side_outputs(case, outcome, room)


@fault("no-reader", writes_stdout)
def no_reader(case):
    """The reader has gone before the first byte."""
    room, is_to_file = case.room(has_old=False), names_files(case)
    source, target = os.pipe()
    os.close(source)
    outcome = case.run(room, Plan(stdout=target), is_to_file, case.stage)
    case.judge(outcome, Expected(case.stage, [141], []), room, "no reader", out_is_checked=False)
    check_side_outputs(case, outcome, room)


def check_side_outputs(case, outcome, room):
    """Files beside stdout are whole, or are not there."""
    whole = case.whole(names_files(case))
    for name, data in outcome.files.items():
        if not whole.has(name, data):
            case.complain("silent loss", f"out/{name} is not whole after the reader of stdout has gone")


@fault("stdout-closed", lambda job, stage: last(job, stage) and not job.is_to_file_only)
def stdout_closed(case):
    """There is no stdout."""
    room = case.room(has_old=False, is_to_file=False)
    outcome = case.run(room, Plan(stdout=-1), is_to_file=False)
    nothing = case.whole(False).stdout == b""
    expected = Expected(case.stage, [0] if nothing else [1], [case.whole(False)], "stdout is closed")
    case.judge(outcome, expected, room, "no stdout")


@fault("stdin-closed", lambda job, stage: stage == 0)
def stdin_closed(case):
    """There is no stdin."""
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    outcome = case.run(room, Plan(stdin=-1, fed=b""), is_to_file)
    expected = Expected(0, [1] if case.job.fed else [0], [whole], "stdin")
    case.judge(outcome, expected, room, "no stdin")


@fault("stderr-full")
def stderr_full(case):
    """Messages cannot be written: results are the same, and so are exit codes."""
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    length = case.numbers.randrange(2 * whole.size())
    log = os.open("/dev/full", os.O_WRONLY)
    try:
        before = {case.stage: lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (length, length))}
        outcome = case.run(room, Plan(stderr=log, before=before), is_to_file)
    finally:
        os.close(log)
    case.judge(
        outcome,
        Expected(case.stage, [0, 1], [whole], is_silent=True),
        room,
        f"no messages, and files of {length} bytes",
    )


@fault("no-data", lambda job, stage: stage == 0 and job.fed)
def no_data(case):
    """An empty stdin."""
    if not case.job.fed:
        raise Skip("reads no stdin")
    room = case.room()
    outcome = case.run(room, Plan(fed=b""))
    expected = Expected(0, [0, 2, 3], [case.whole(True)], "no points|empty")
    case.judge(outcome, expected, room, "empty stdin", is_hit=True, out_is_checked=any(outcome.codes))
