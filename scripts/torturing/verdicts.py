"""Judges an outcome by what README.md promises of exit codes, messages and outputs."""

import re
import signal

import runs

SILENT, CODE, LEFTOVER, PANIC, HANG, MESSAGE = KINDS = (
    "silent loss",
    "exit code",
    "leftover",
    "panic",
    "hang",
    "message",
)

CLOSED_PIPE, MALFORMED = 141, 3
# Signals by which no program should end unless they were sent.
CRASHES = {signal.SIGABRT, signal.SIGSEGV, signal.SIGBUS, signal.SIGILL, signal.SIGFPE, signal.SIGTRAP}
# What a run measures, when it ran, and what follows from the folder it ran in.
MEASURED = re.compile(rb'"(?:seconds|cpu_seconds|peak_memory_bytes|host|checksum|id)": ?[^,}]*')
# A name that an output has for a moment, when it replaces a file; SIGKILL may come just then.
MOMENTARY = re.compile(r"(.*/)?\.spmesh-\w+$")


class Whole:
    """The outputs of an undisturbed run, the seconds it took, and what else is right."""

    def __init__(self, outcome):
        self.stdout, self.seconds = outcome.stdout, outcome.seconds
        self.files = {name: comparable(name, data) for name, data in outcome.files.items()}

    def has(self, name, data):
        return name in self.files and comparable(name, data) == self.files[name]

    def size(self):
        return max([len(self.stdout), *map(len, self.files.values())])


def comparable(name, data):
    """An output without what differs from run to run."""
    if name == "plan.json":
        # A plan remembers the place, the length and the time of each file, on which names of nodes depend.
        data = re.sub(rb'"(?:bytes|modified)":\d+|"name":"[0-9a-f]{16}"', b"", data)
    if name.endswith(".json"):
        return MEASURED.sub(b"", data)
    if name.endswith("summary.tsv"):
        # Rows come in the order in which files were done. The first columns are results but for time and
        # memory; the last ones tell what kind of file the input was.
        rows = (row.split(b"\t") for row in data.splitlines())
        return b"\n".join(sorted(b"\t".join(row[:6] + row[8:14]) for row in rows))
    return data


class Expected:
    """What a fault may lead to.

    `stage` is the program that the fault hits, `codes` are those with which it may fail; 0 is for a run that
    the fault did not stop. `cause` is in the message of a failure. `wholes` are the complete outputs, one of
    which must be there after a success.
    """

    def __init__(
        self, stage, codes, wholes, cause="", signals=(), is_silent=False, is_read=True, momentary=False
    ):
        self.stage, self.codes, self.wholes, self.cause = stage, set(codes), wholes, cause
        self.signals, self.is_silent, self.is_read, self.momentary = (
            set(signals),
            is_silent,
            is_read,
            momentary,
        )


def judge(outcome, expected, old, out_is_checked=True):
    """What is wrong about an outcome: pairs of a kind and a description."""
    found = []
    if outcome.is_hanging:
        return [(HANG, f"more than {runs.TIME_MAX} s")]
    text = "".join(outcome.messages)
    if "panicked" in text or "RUST_BACKTRACE" in text:
        found.append((PANIC, text[-300:]))
    for code in outcome.codes:
        if code == 101 or code < 0 and -code in CRASHES - expected.signals:
            found.append((PANIC, f"exit codes {outcome.codes}"))
    found += [(LEFTOVER, stray) for stray in outcome.strays]
    found += judge_codes(outcome, expected)
    found += judge_messages(outcome, expected)
    if out_is_checked:
        found += judge_files(outcome, expected, old)
    return found


def has_succeeded(outcome):
    return not any(outcome.codes)


def is_copying(outcome, stage):
    """Whether a program passes its input on as it is, damaged or whole, whatever its own output becomes."""
    return "--tee" in outcome.commands[stage]


def judge_codes(outcome, expected):
    codes, k = outcome.codes, expected.stage
    allowed = expected.codes | {-number for number in expected.signals}
    found = []
    if codes[k] not in allowed:
        found.append(f"{outcome.commands[k][0]} ended with {codes[k]}, expected {sorted(allowed)}")
    for i in range(k):
        # A program whose reader has gone, or one that the same signal hit.
        if codes[i] not in {0, CLOSED_PIPE} | {-number for number in expected.signals}:
            found.append(f"{outcome.commands[i][0]}, before it, ended with {codes[i]}")
    passed_on = MALFORMED if codes[k] < 0 else codes[k]
    for i in range(k + 1, len(codes)):
        # A program that was killed may have written everything before; the next one succeeds then.
        fine = {passed_on} | ({0} if codes[k] < 0 or is_copying(outcome, k) else set())
        fine |= {-number for number in expected.signals}
        if codes[k] == CLOSED_PIPE:
            continue
        if codes[i] not in fine:
            found.append(
                f"{outcome.commands[i][0]}, behind it, ended with {codes[i]}, expected {sorted(fine)}"
            )
    return [(CODE, f"{text}; all: {codes}") for text in found]


def judge_messages(outcome, expected):
    """One message of the cause, and none of the programs around it."""
    if not expected.is_read:
        return []
    k, found = expected.stage, []
    codes = outcome.codes
    speaker = None if codes[k] in (0, CLOSED_PIPE) or expected.is_silent else k
    if codes[k] < 0:
        # The next program finds that its input is cut off.
        speaker = next((i for i in range(k + 1, len(codes)) if codes[i] == MALFORMED), None)
    for i, said in enumerate(outcome.messages):
        lines = said.splitlines()
        tool = outcome.commands[i][0]
        is_copied = speaker is not None and i == speaker + 1 and is_copying(outcome, speaker)
        # A sweep goes on with the other files, and says of each what failed.
        is_sweep = any("out/sweep" in word for word in outcome.commands[i]) and codes[i] == 1
        if is_copied or is_sweep and i == speaker and lines:
            continue
        if i != speaker and lines:
            found.append(f"{tool} should be silent: {said[-300:]!r}")
        elif i == speaker and codes[i] and len(lines) != 1:
            found.append(f"{tool} said {len(lines)} lines, expected one: {said[-300:]!r}")
        elif i == speaker and not (lines[0].startswith(f"{tool}: ") or lines[0] == "not enough memory"):
            found.append(f"{tool} does not name itself: {said[-300:]!r}")
        elif i == speaker and i == k and not re.search(expected.cause, said, re.IGNORECASE):
            found.append(f"{tool} does not say {expected.cause!r}: {said[-300:]!r}")
    return [(MESSAGE, text) for text in found]


def judge_files(outcome, expected, old):
    """Complete outputs after a success; after a failure complete ones, old ones or none."""
    found = []
    wholes = expected.wholes
    success = has_succeeded(outcome)
    for name, data in outcome.files.items():
        if any(whole.has(name, data) for whole in wholes):
            continue
        if data == runs.OLD and name in old and not success:
            continue
        # The summary of a sweep grows with each file, so that a later run can go on.
        if name.endswith("summary.tsv") and not success:
            continue
        if expected.momentary and old and MOMENTARY.match(name):
            continue
        is_known = any(name in whole.files for whole in wholes)
        kind = SILENT if is_known else LEFTOVER
        found.append((kind, f"out/{name}: {len(data)} bytes that are not those of a whole run"))
    for name in old:
        if name not in outcome.files and not success:
            found.append((SILENT, f"out/{name}: the earlier file is gone"))
    if success and not any(set(outcome.files) == set(whole.files) for whole in wholes):
        missing = set(wholes[0].files) - set(outcome.files)
        found.append((SILENT, f"success without {sorted(missing)}, or with more"))
    if success and not any(outcome.stdout == whole.stdout for whole in wholes):
        found.append(
            (SILENT, f"success, but {len(outcome.stdout)} bytes on stdout are not those of a whole run")
        )
    return found
