"""Processes of scripts/soak: pipes, the greatest memory of each program, samples of those that live long."""

import contextlib
import ctypes
import os
import pathlib
import signal
import subprocess
import tempfile
import threading
import time

# A stage that takes longer hangs. Machines that freeze processes to measure others do so for minutes.
PATIENCE = 900
TICK = os.sysconf("SC_CLK_TCK")
# Linux counts the memory of the process that starts a program as that of the program. So a shell of little memory
# starts it and ends, and this script becomes its parent (prctl PR_SET_CHILD_SUBREAPER). Until then the program waits at
# a FIFO, or the shell might collect its exit code.
LAUNCH = 'exec 3<&0; (read -r _ < "$0.go"; exec "$@") <&3 3<&- & echo $! > "$0"'
SUBREAPER = 36
# In the message of a panic, also in one of a thread whose end no other thread notices.
PANIC = "panicked"


def said(messages):
    """What programs wrote to the file of their messages."""
    return messages.read_text(errors="replace").strip()


class Process:
    """A running program, with its ends of pipes."""

    def __init__(self, command, **redirected):
        ctypes.CDLL(None).prctl(SUBREAPER, 1)
        with tempfile.TemporaryDirectory() as folder:
            number, go = pathlib.Path(folder, "pid"), pathlib.Path(folder, "pid.go")
            os.mkfifo(go)
            shell = subprocess.Popen(["/bin/sh", "-c", LAUNCH, number, *map(str, command)], **redirected)
            shell.wait()
            self.pid = int(number.read_text())
            go.write_text("\n")
        self.stdin, self.stdout, self.returncode = shell.stdin, shell.stdout, None


class Meter:
    """Processor time of all programs and of this one."""

    def __init__(self):
        self.lock, self.finished, self.alive = threading.Lock(), 0.0, {}

    def ended(self, pid, usage):
        with self.lock:
            self.finished += usage.ru_utime + usage.ru_stime
            self.alive.pop(pid, None)

    def sampled(self, pid, seconds):
        with self.lock:
            self.alive[pid] = seconds

    def seconds(self):
        with self.lock:
            return time.process_time() + self.finished + sum(self.alive.values())


class Pipe:
    """Programs that are connected by pipes. A command is a list of words; the first names the program."""

    def __init__(self, meter, programs, commands, folder, scratch, messages, stdin=subprocess.DEVNULL, stdout=None):
        self.meter, self.names, self.processes = meter, [command[0] for command in commands], []
        environment = {**os.environ, "TMPDIR": str(scratch)}
        for command in commands:
            is_last = command is commands[-1]
            process = Process(
                [programs / command[0], *command[1:]],
                stdin=stdin,
                stdout=(stdout or subprocess.DEVNULL) if is_last else subprocess.PIPE,
                stderr=messages, cwd=folder, env=environment,
            )
            if self.processes:
                self.processes[-1].stdout.close()
            self.processes.append(process)
            stdin = process.stdout

    def wait(self):
        """The exit code and the greatest resident memory in bytes of each program."""
        watch = threading.Timer(PATIENCE, self.kill)
        watch.daemon = True
        watch.start()
        codes, peaks = [], []
        for process in self.processes:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self.meter.ended(process.pid, usage)
            codes.append(process.returncode)
            peaks.append(usage.ru_maxrss * 1024)
        watch.cancel()
        return codes, peaks

    def kill(self):
        for process in self.processes:
            if process.returncode is None:
                os.kill(process.pid, signal.SIGKILL)


class Samples:
    """Resident memory and descriptors of one process, again and again."""

    def __init__(self, meter, pid, program):
        self.meter, self.pid, self.program = meter, pid, program
        self.memory, self.descriptors = [], []

    def take(self):
        with contextlib.suppress(FileNotFoundError, ProcessLookupError, PermissionError, IndexError):
            with open(f"/proc/{self.pid}/statm") as file:
                pages = int(file.read().split()[1])
            descriptors = len(os.listdir(f"/proc/{self.pid}/fd"))
            with open(f"/proc/{self.pid}/stat") as file:
                fields = file.read().rsplit(")", 1)[1].split()
            # A process that has ended and waits for its parent has no memory any more.
            if pages > 0 and descriptors > 0:
                self.memory.append(pages * os.sysconf("SC_PAGE_SIZE"))
                self.descriptors.append(descriptors)
                self.meter.sampled(self.pid, (int(fields[11]) + int(fields[12])) / TICK)

    def skip(self, part):
        """Forgets the first samples."""
        first = int(part * len(self.memory))
        del self.memory[:first], self.descriptors[:first]


class Sampler(threading.Thread):
    """Takes samples of all programs of a pipe until it is told to stop."""

    def __init__(self, meter, pipe, interval):
        super().__init__(daemon=True)
        self.interval, self.over = interval, threading.Event()
        self.samples = [Samples(meter, p.pid, name) for p, name in zip(pipe.processes, pipe.names)]
        self.start()

    def run(self):
        while not self.over.wait(self.interval):
            for samples in self.samples:
                samples.take()

    def stop(self):
        self.over.set()
        self.join()
        return self.samples
