"""Runs fuzz targets by cargo-fuzz, and prints what each of them has done. Needs Linux."""

import argparse
import concurrent.futures
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
TRIPLE = re.compile(r"host: (\S+)")
# Restarts of a target after a finding: the same fault may end each of them.
RESTARTS = 5
# libFuzzer measures wall time. An input that takes this many times the limit is tried again, by processor
# time.
WALL = 20


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/fuzz coverage", description=__doc__)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help="all targets if none is named")
    parser.add_argument("--seconds", type=int, default=60, metavar="N", help="processor time for each target")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="targets that run at once")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "target" / "fuzz", metavar="FOLDER",
                        help="folder for corpora, findings and logs; corpora grow from run to run")
    parser.add_argument("--target-dir", type=pathlib.Path, default=ROOT / "target" / "libfuzzer",
                        metavar="FOLDER", help="folder of the build")
    parser.add_argument("--max-len", type=int, default=1 << 14, metavar="N", help="most bytes of an input")
    parser.add_argument("--memory", type=int, default=1024, metavar="MIB", help="most memory of an input")
    parser.add_argument("--timeout", type=int, default=30, metavar="N",
                        help="processor time after which an input hangs")
    parser.add_argument("--nightly", action="store_true", help="check addresses, too, on nightly Rust")
    return parser.parse_args()


def build(flags):
    """Builds the program of all targets."""
    toolchain = ["+nightly"] if flags.nightly else []
    sanitizer = "address" if flags.nightly else "none"
    environment = os.environ | ({} if flags.nightly else {"RUSTC_BOOTSTRAP": "1"})
    command = ["cargo", *toolchain, "fuzz", "build", "--fuzz-dir", "tests/fuzz", "--sanitizer", sanitizer,
               "--target-dir", str(flags.target_dir), "any"]
    subprocess.run(command, cwd=ROOT, env=environment, check=True)
    version = subprocess.run(["rustc", "-vV"], capture_output=True, text=True, check=True).stdout
    return flags.target_dir / TRIPLE.search(version)[1] / "release" / "any"


def names_of(program, corpus):
    """The names of all targets, after their samples are written."""
    corpus.mkdir(parents=True, exist_ok=True)
    environment = os.environ | {"FUZZ_SAMPLES": str(corpus)}
    listed = subprocess.run([program], env=environment, check=True, stdout=subprocess.PIPE, text=True)
    return listed.stdout.split()


def last(pattern, text, default=0):
    found = re.findall(pattern, text)
    return int(found[-1]) if found else default


class Target:
    """What is known of one target: executions, processor time, edges, and the files of findings."""

    def __init__(self, program, name, flags):
        self.program, self.name, self.flags = program, name, flags
        self.corpus, self.findings = flags.out / "corpus" / name, flags.out / "findings"
        self.executions, self.cpu, self.edges, self.found = 0, 0.0, 0, []

    def __str__(self):
        return f"{self.name:<15} {self.executions:>11} {self.cpu:>9.1f} {self.edges:>9} {len(self.found):>9}"

    def run(self):
        """Runs the target for its time, again after each finding."""
        self.corpus.mkdir(parents=True, exist_ok=True)
        while len(self.found) <= RESTARTS and self.cpu < self.flags.seconds and self.once():
            pass
        return self

    def once(self):
        """Runs the target until its time is up or an input ends it; then more may follow."""
        flags, log = self.flags, self.flags.out / f"{self.name}.log"
        command = [f"-max_len={flags.max_len}", "-print_final_stats=1", f"-rss_limit_mb={flags.memory}",
                   f"-timeout={WALL * flags.timeout}", f"-report_slow_units={WALL * flags.timeout}",
                   "-close_fd_mask=1", f"-artifact_prefix={self.findings}/{self.name}-", self.corpus]
        code, cpu = self.call(command, log, flags.seconds - self.cpu)
        text = log.read_text(errors="replace")
        self.cpu += cpu
        self.executions += last(r"stat::number_of_executed_units:\s*(\d+)", text, last(r"\n#(\d+)\s", text))
        self.edges = max(self.edges, last(r"cov: (\d+)", text))
        if code == 0:
            return False
        written = re.findall(r"Test unit written to (\S+)", text)
        if not written:
            copy = shutil.copy(log, self.findings / f"{self.name}-{int(time.time())}.log")
            self.found.append(f"{self.name} ended with {code}: see {copy}")
        elif f"{self.name}-timeout-" not in written[-1] or self.hangs(written[-1]):
            self.found.append(written[-1])
        return True

    def hangs(self, path):
        """Whether an input takes too much processor time: wall time says little of a process that waits."""
        code, _ = self.call(["-timeout=0", path], os.devnull, self.flags.timeout, signal.SIGKILL)
        if code == 0:
            os.unlink(path)
        return code != 0

    def call(self, words, log, seconds, end=signal.SIGUSR1):
        """Runs the program of all targets, and sends a signal after some processor time: code and time.

        After SIGUSR1, libFuzzer ends with the current input.
        """
        environment = os.environ | {"FUZZ_TARGET": self.name}
        with open(log, "wb") as output, tempfile.TemporaryDirectory() as environment["TMPDIR"]:
            process = subprocess.Popen([self.program, *map(str, words)], env=environment, stdout=output,
                                       stderr=output)
            while not (ended := os.wait4(process.pid, os.WNOHANG))[0]:
                if processor_time(process.pid) >= seconds:
                    process.send_signal(end)
                time.sleep(0.2)
        process.returncode = os.waitstatus_to_exitcode(ended[1])
        return process.returncode, ended[2].ru_utime + ended[2].ru_stime


def processor_time(pid):
    """Seconds that a process that has not ended took so far."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main():
    flags = arguments()
    flags.out, flags.target_dir = flags.out.resolve(), flags.target_dir.resolve()
    program = build(flags)
    known = names_of(program, flags.out / "corpus")
    if unknown := [name for name in flags.targets if name not in known]:
        sys.exit(f"there is no target {unknown[0]} among {' '.join(known)}")
    (flags.out / "findings").mkdir(parents=True, exist_ok=True)
    names = flags.targets or known
    print(f"{'target':<15} {'executions':>11} {'CPU s':>9} {'edges':>9} {'findings':>9}", flush=True)
    targets = [Target(program, name, flags) for name in names]
    with concurrent.futures.ThreadPoolExecutor(flags.jobs) as pool:
        for target in pool.map(Target.run, targets):
            print(target, flush=True)
    print(f"{len(targets)} targets: {sum(target.executions for target in targets)} executions, "
          f"{sum(target.cpu for target in targets):.0f} s")
    findings = [finding for target in targets for finding in target.found]
    print(*findings, sep="\n", end="\n" if findings else "")
    sys.exit(1 if findings else 0)


if __name__ == "__main__":
    main()
