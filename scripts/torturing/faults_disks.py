"""Full disks, files that may not grow, and folders that nobody may write to."""

import os
import resource
import shutil

import users
from cases import Expected, Plan, Skip, fault, first_failed, last

FULL = "No space left on device"


def to_file(case):
    if case.job.is_to_stdout_only:
        raise Skip("writes to stdout alone")
    return case.whole(True)


@fault("file-size")
def file_size(case):
    """No file may grow beyond a length."""
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    # The message goes to a file, too.
    length = max(case.numbers.randrange(whole.size()), 500)

    def before():
        resource.setrlimit(resource.RLIMIT_FSIZE, (length, length))

    outcome = case.run(room, Plan(before={case.stage: before}), is_to_file)
    case.judge(outcome, Expected(case.stage, [0, 1], [whole], "too large"), room, f"files of {length} bytes")


@fault("dev-full", last)
def dev_full(case):
    """A device that is always full, by name or as stdout."""
    names = case.job.outputs()
    by_name = bool(names) and (case.job.is_to_file_only or case.numbers.random() < 0.5)
    if not by_name and case.job.is_to_file_only:
        raise Skip("writes no file of a fixed name")
    room = case.room(has_old=False)
    if by_name:
        # The ending may choose the format; a link has both.
        (room.folder / case.numbers.choice(names)).symlink_to("/dev/full")
        outcome = case.run(room)
    else:
        outcome = case.run(room, Plan(stdout=os.open("/dev/full", os.O_WRONLY)), is_to_file=False)
    whole = case.whole(by_name)
    case.judge(outcome, Expected(case.stage, [1], [whole], FULL), room, "a full device")


@fault("full-disk", last)
def full_disk(case):
    """A file system that has less room than the output needs."""
    whole = to_file(case)
    room = case.room(has_old=False)
    size = sum(map(len, whole.files.values()))
    pages = case.numbers.randrange(1, max(2, size // 4096))
    if not case.world.can_mount or not room.mount(room.out, f"size={4096 * pages}"):
        raise Skip("file systems cannot be mounted")
    outcome = case.run(room)
    case.judge(
        outcome,
        Expected(first_failed(outcome, case.stage), [0, 1], [whole], FULL),
        room,
        f"a disk of {pages} pages",
    )


@fault("no-inodes", last)
def no_inodes(case):
    """A file system on which no file can be made."""
    whole = to_file(case)
    room = case.room(has_old=False)
    if not case.world.can_mount or not room.mount(room.out, "nr_inodes=1"):
        raise Skip("file systems cannot be mounted")
    outcome = case.run(room)
    case.judge(
        outcome,
        Expected(first_failed(outcome, case.stage), [1], [whole], FULL),
        room,
        "a disk without inodes",
    )


@fault("read-only", last)
def read_only(case):
    """A file system that is mounted to be read only, with earlier files."""
    whole = to_file(case)
    room = case.room(has_old=False)
    if not case.world.can_mount or not room.mount(room.out, "size=1m"):
        raise Skip("file systems cannot be mounted")
    if case.numbers.random() < 0.5 and "spnode" not in case.job.tools:
        room.place_old(name for name in whole.files)
    room.mount(room.out, "remount,ro")
    outcome = case.run(room)
    case.judge(
        outcome,
        Expected(first_failed(outcome, case.stage), [1], [whole], "Read-only file system"),
        room,
        "a disk to be read only",
    )


@fault("refused", last)
def refused(case):
    """A folder of another user."""
    whole = to_file(case)
    if case.world.user is None:
        raise Skip("no other user can run the programs")
    room = case.room()
    users.give(room.folder, case.world.user)
    os.chown(room.out, 0, 0)
    os.chmod(room.out, 0o555)
    before = {k: users.become(case.world.user) for k in range(len(case.job.stages))}
    outcome = case.run(room, Plan(before=before))
    case.judge(
        outcome,
        Expected(first_failed(outcome, case.stage), [1], [whole], "Permission denied"),
        room,
        "a folder of another user",
    )


@fault("full-temp")
def full_temp(case):
    """A folder for temporary files that is full, refuses files, or is not there."""
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    kind = case.numbers.choice(["full", "no inodes", "read only", "missing"])
    options = {
        "full": f"size={4096 * case.numbers.randrange(1, 9)}",
        "no inodes": "nr_inodes=1",
        "read only": "ro",
    }
    environment = {}
    if kind == "missing":
        environment["TMPDIR"] = str(room.folder / "missing")
    elif not case.world.can_mount or not room.mount(room.tmp, options[kind]):
        raise Skip("file systems cannot be mounted")
    # Every program of the pipe has this folder; the first that fails is to blame.
    outcome = case.run(room, Plan(environment=environment), is_to_file)
    stage = first_failed(outcome, case.stage)
    cause = {"missing": "No such file or directory", "read only": "Read-only file system"}.get(kind, FULL)
    case.judge(outcome, Expected(stage, [0, 1], [whole], cause), room, f"temporary files: {kind}")


@fault("no-folder", last)
def no_folder(case):
    """The folder of the output is not there. Programs make folders that are named as such."""
    whole = to_file(case)
    room = case.room(has_old=False)
    shutil.rmtree(room.out)
    outcome = case.run(room)
    room.out.mkdir(exist_ok=True)
    makes = case.job.name in ("nodes", "sweep", "heights", "classes", "sheets", "levels", "tiles")
    expected = Expected(
        first_failed(outcome, case.stage),
        [0] if makes else [1],
        [whole],
        "No such file or directory|does not exist",
    )
    case.judge(outcome, expected, room, "no folder")
