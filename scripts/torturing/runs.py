"""Runs a pipe in a folder of its own, with limits, disturbances and a time limit."""

import dataclasses
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import time

import inputs

# Seconds after which a run counts as hanging, and seconds without any processor time. Debug builds are slow.
TIME_MAX, IDLE_MAX = 240, 25
# A pause of this script is not counted as longer than this: the machine may freeze all processes for minutes.
TICK_MAX = 0.2
# Bytes of a file that an output must not touch before it is complete.
OLD = b"An earlier file of this name.\n"
CHUNK = 1 << 16


class Room:
    """A folder with in/, out/ and tmp/, in which a job runs."""

    def __init__(self, folder, source, job):
        self.folder = pathlib.Path(folder)
        self.folder.mkdir()
        self.out, self.tmp = self.folder / "out", self.folder / "tmp"
        for made in (self.out, self.tmp):
            made.mkdir()
        self.inputs = self.folder / "in"
        inputs.copy(source, self.inputs, job.all_inputs())
        self.states = {name: state(self.inputs / name) for name in job.all_inputs()}
        # Inputs that the fault itself changes.
        self.disturbed = set()
        self.mounts, self.old = [], []

    def changed_inputs(self):
        """Inputs that a program has changed."""
        return [
            name
            for name, it in self.states.items()
            if name not in self.disturbed and state(self.inputs / name) != it
        ]

    def place_old(self, names):
        """Puts earlier files where outputs will be."""
        for name in names:
            path = self.out / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(OLD)
            self.old.append(name)

    def mount(self, folder, options):
        """Mounts a file system in memory; False if that is not allowed."""
        command = ["mount", "-t", "tmpfs", "-o", options, "torture", str(folder)]
        if subprocess.run(command, stderr=subprocess.DEVNULL).returncode:
            return False
        if folder not in self.mounts:
            self.mounts.append(folder)
        return True

    def close(self):
        for folder in self.mounts:
            subprocess.run(["umount", "-l", str(folder)], check=False)
        shutil.rmtree(self.folder, ignore_errors=True)


def state(path):
    """What changes if someone writes to a file, or makes or removes one in a folder."""
    if path.is_dir():
        return [(below.name, *state(below)) for below in sorted(path.iterdir())]
    it = os.stat(path) if path.exists() else None
    return (it.st_ino, it.st_size, it.st_mtime_ns) if it else None


@dataclasses.dataclass
class Plan:
    """How a run is disturbed."""

    # By the number of a stage: what its process does before the program starts.
    before: dict = dataclasses.field(default_factory=dict)
    # Called with the processes and the seconds since the start, until it returns True.
    during: object = None
    # By the number of a stage: sizes of the pieces in which its input is passed on, and pauses before them.
    relays: dict = dataclasses.field(default_factory=dict)
    # Reads what the last program writes to stdout, and returns it.
    reader: object = None
    # Instead of the fed input.
    fed: bytes | None = None
    # Replaces stdout of the last program, and stdin of the first: descriptors.
    stdout: int | None = None
    stdin: int | None = None
    stderr: int | None = None
    # Threads to start beside the programs: functions without arguments.
    beside: list = dataclasses.field(default_factory=list)
    # Called when all programs have ended.
    after: object = None
    environment: dict = dataclasses.field(default_factory=dict)


@dataclasses.dataclass
class Outcome:
    """What a run did."""

    commands: list
    codes: list
    messages: list
    stdout: bytes
    files: dict
    strays: list
    is_hanging: bool
    seconds: float


def run(room, job, commands, programs, plan):
    """Runs commands as a pipe in a room and returns the outcome."""
    started = time.monotonic()
    stages, threads = [], []
    logs = [open(room.folder / f"stderr.{k}", "w+b") for k in range(len(commands))]
    stdin = plan.stdin
    fed = plan.fed if plan.fed is not None else (room.inputs / job.fed).read_bytes() if job.fed else None
    if stdin is None and fed is not None:
        stdin, feeder = os.pipe()
        relay = plan.relays.get(0)
        threads.append(lambda: feed(feeder, fed, relay))
    elif stdin is None:
        stdin = os.open(os.devnull, os.O_RDONLY)
    collected = []
    group = None
    for k, command in enumerate(commands):
        is_last = k == len(commands) - 1
        after = None
        if is_last and plan.stdout is not None:
            stdout = plan.stdout
        else:
            after, stdout = os.pipe()
        stages.append(start(room, programs, command, stdin, stdout, logs[k], plan, k, group))
        group = group or stages[0].pid
        for descriptor in {stdin, stdout} - {-1}:
            os.close(descriptor)
        stdin = after
        if after is not None and is_last:
            threads.append(lambda source=after: collected.append((plan.reader or read_all)(source)))
        elif k + 1 in plan.relays:
            stdin, target = os.pipe()
            threads.append(lambda a=after, b=target, k=k: relay_all(a, b, plan.relays[k + 1]))
    threads += plan.beside
    threads = [threading.Thread(target=thread, daemon=True) for thread in threads]
    for thread in threads:
        thread.start()
    is_hanging = wait(stages, plan.during)
    strays = end_group(group)
    if plan.after:
        plan.after()
    for thread in threads:
        thread.join(30)
    messages = []
    for log in logs:
        log.seek(0)
        messages.append(log.read().decode(errors="replace"))
        log.close()
    files, strays = contents(room, job, strays)
    codes = [stage.returncode for stage in stages]
    stdout = b"".join(part for part in collected if part)
    return Outcome(commands, codes, messages, stdout, files, strays, is_hanging, time.monotonic() - started)


def start(room, programs, command, stdin, stdout, log, plan, k, group):
    """Starts a program of the pipe in its process group, which the first one founds."""
    before = plan.before.get(k)

    def prepare():
        os.setpgid(0, group or 0)
        # Under nohup or in the background, the program would inherit that signals are ignored.
        signal.pthread_sigmask(signal.SIG_SETMASK, [])
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_DFL)
        if before:
            before()

    environment = {**os.environ, "TMPDIR": str(room.tmp), "RUST_BACKTRACE": "0", **plan.environment}
    stderr = plan.stderr if plan.stderr is not None else log
    closed = {name: subprocess.DEVNULL for name, it in (("stdin", stdin), ("stdout", stdout)) if it == -1}
    streams = {"stdin": stdin, "stdout": stdout, "stderr": stderr, **closed}
    if closed:
        inner, numbers = prepare, [0 if name == "stdin" else 1 for name in closed]

        def prepare_closed():
            inner()
            for number in numbers:
                os.close(number)

        streams["preexec_fn"] = prepare_closed
    else:
        streams["preexec_fn"] = prepare
    return subprocess.Popen(
        [f"{programs}/{command[0]}", *command[1:]], cwd=room.folder, env=environment, **streams
    )


def wait(stages, during):
    """Waits for the end of all programs; whether they took too long."""
    counted, before = 0.0, time.monotonic()
    start_time, worked, used = before, 0.0, 0
    while any(stage.poll() is None for stage in stages):
        now = time.monotonic()
        if during and during(stages, now - start_time):
            during = None
        counted += min(now - before, TICK_MAX)
        before = now
        if counted - worked > IDLE_MAX / 5 and processor_time(stages) != used:
            worked, used = counted, processor_time(stages)
        if counted > TIME_MAX or counted - worked > IDLE_MAX:
            for stage in stages:
                stage.kill()
                stage.wait()
            return True
        time.sleep(0.002)
    return False


def processor_time(stages):
    """Ticks of the processor that the programs have taken so far."""
    total = 0
    for stage in stages:
        try:
            fields = (
                pathlib.Path(f"/proc/{stage.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
            )
            total += int(fields[11]) + int(fields[12])
        except OSError:
            pass
    return total


def end_group(group):
    """Kills what is left of a process group; says what there was."""
    # A program that has just ended leaves the group a moment later.
    for _ in range(50):
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return []
        time.sleep(0.01)
    os.killpg(group, signal.SIGKILL)
    return ["a process that is still running"]


def feed(target, data, relay):
    """Writes bytes to a pipe, whose reader may go away."""
    if relay:
        source, into = os.pipe()
        pump = threading.Thread(target=feed, args=(into, data, None), daemon=True)
        pump.start()
        relay_all(source, target, relay)
        pump.join()
        return
    try:
        view = memoryview(data)
        while view:
            view = view[os.write(target, view[:CHUNK]) :]
    except BrokenPipeError:
        pass
    finally:
        os.close(target)


def relay_all(source, target, sizes):
    """Copies a pipe; `sizes` yields how many bytes to pass on at a time, and seconds to wait before."""
    try:
        for size, pause in sizes:
            if pause:
                time.sleep(pause)
            data = os.read(source, size)
            if not data:
                break
            view = memoryview(data)
            while view:
                view = view[os.write(target, view) :]
    except BrokenPipeError:
        pass
    finally:
        os.close(source)
        os.close(target)


def read_all(source):
    parts = []
    while part := os.read(source, CHUNK):
        parts.append(part)
    os.close(source)
    return b"".join(parts)


def without_folder(room, name, data):
    """An output without the path of the room: manifests name parts in other folders by their whole path."""
    return data.replace(bytes(room.folder), b"") if name.endswith(".json") else data


def contents(room, job, strays):
    """The files in out/, by name; and what is where nothing should be."""
    files = {}
    for path in sorted(room.out.rglob("*")):
        name = str(path.relative_to(room.out))
        if path.is_file() and not path.is_symlink():
            files[name] = without_folder(room, name, path.read_bytes())
    strays += [f"tmp/{path.name}" for path in room.tmp.iterdir()]
    known = {"in", "out", "tmp", *(f"stderr.{k}" for k in range(len(job.stages)))}
    strays += [path.name for path in room.folder.iterdir() if path.name not in known]
    return files, strays
