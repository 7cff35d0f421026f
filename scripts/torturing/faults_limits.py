"""Limits of the system: memory, descriptors, processes."""

import resource

import users
from cases import Expected, Plan, Skip, fault


def limited(case, kind, values, expected_codes, cause, what):
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)

    def before():
        resource.setrlimit(kind, (values, values))

    outcome = case.run(room, Plan(before={case.stage: before}), is_to_file)
    if "error while loading shared libraries" in outcome.messages[case.stage]:
        raise Skip("not even the program can be loaded")
    case.judge(outcome, Expected(case.stage, expected_codes, [whole], cause), room, f"{what} {values}")


@fault("memory")
def memory(case):
    """Little address space."""
    least = case.world.least_space[case.tool]
    space = least + int((case.numbers.random() ** 3) * 120e6)
    limited(case, resource.RLIMIT_AS, space, [0, 1, 5], "memory|thread|allocate", "address space of")


@fault("files")
def files(case):
    """Few descriptors."""
    count = case.numbers.randrange(4, 14)
    limited(case, resource.RLIMIT_NOFILE, count, [0, 1], "Too many open files", "descriptors:")


@fault("processes")
def processes(case):
    """Few threads, which count as processes of the user."""
    if case.world.user is None:
        raise Skip("no other user can run the programs")
    is_to_file = case.is_to_file()
    whole, room = case.whole(is_to_file), case.room(is_to_file=is_to_file)
    users.give(room.folder, case.world.user)
    # All cases that run at this moment have the same user: each of them alone may have more.
    count = case.numbers.choice([1, 2, 3, 4, 5, 8])
    become = users.become(case.world.user)

    def before():
        resource.setrlimit(resource.RLIMIT_NPROC, (count, count))
        become()

    outcome = case.run(room, Plan(before={case.stage: before}), is_to_file)
    case.judge(outcome, Expected(case.stage, [0, 1], [whole], "thread"), room, f"{count} processes")
