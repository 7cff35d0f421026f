"""Runs fuzz targets by cargo-fuzz in turn, and prints what each of them has done."""

import argparse
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
FUZZ = ROOT / "tests" / "fuzz"
TRIPLE = re.compile(r"host: (\S+)")
# Restarts of a target after a finding: the same fault may end each of them.
RESTARTS = 5


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/fuzz coverage", description=__doc__)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help="all targets if none is named")
    parser.add_argument("--seconds", type=int, default=60, metavar="N", help="wall time for each target")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "target" / "fuzz", metavar="FOLDER",
                        help="folder for corpora, findings and logs; corpora grow from run to run")
    parser.add_argument("--target-dir", type=pathlib.Path, default=ROOT / "target" / "libfuzzer",
                        metavar="FOLDER", help="folder of the build")
    parser.add_argument("--max-len", type=int, default=1 << 14, metavar="N", help="most bytes of an input")
    parser.add_argument("--memory", type=int, default=1024, metavar="MIB", help="most memory of an input")
    parser.add_argument("--timeout", type=int, default=30, metavar="N", help="seconds until an input hangs")
    parser.add_argument("--nightly", action="store_true", help="check addresses, too, on nightly Rust")
    return parser.parse_args()


def build(flags):
    """Builds the program of all targets, and the driver that knows their names and samples."""
    toolchain = ["+nightly"] if flags.nightly else []
    sanitizer = "address" if flags.nightly else "none"
    environment = os.environ | ({} if flags.nightly else {"RUSTC_BOOTSTRAP": "1"})
    command = ["cargo", *toolchain, "fuzz", "build", "--fuzz-dir", "tests/fuzz", "--sanitizer", sanitizer,
               "--target-dir", str(flags.target_dir), "any"]
    subprocess.run(command, cwd=ROOT, env=environment, check=True)
    version = subprocess.run(["rustc", "-vV"], capture_output=True, text=True, check=True).stdout
    return flags.target_dir / TRIPLE.search(version)[1] / "release" / "any"


def driver(*words):
    command = ["cargo", "run", "--quiet", "--locked", "--package", "spmesh-fuzz", "--", *words]
    return subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout


def last(pattern, text, default=0):
    found = re.findall(pattern, text)
    return int(found[-1]) if found else default


def once(program, name, seconds, flags):
    """Runs a target until time is up or a finding ends it: executions, coverage, and the finding's file."""
    corpus, findings = flags.out / "corpus" / name, flags.out / "findings"
    log = flags.out / f"{name}.log"
    command = [str(program), f"-max_total_time={seconds}", f"-max_len={flags.max_len}", "-print_final_stats=1",
               f"-rss_limit_mb={flags.memory}", f"-timeout={flags.timeout}", "-close_fd_mask=1",
               f"-artifact_prefix={findings}/{name}-", str(corpus)]
    with open(log, "wb") as output:
        code = subprocess.run(command, env=os.environ | {"FUZZ_TARGET": name}, stdout=output, stderr=output).returncode
    text = log.read_text(errors="replace")
    executions = last(r"stat::number_of_executed_units:\s*(\d+)", text, last(r"\n#(\d+)\s", text))
    finding = re.findall(r"Test unit written to (\S+)", text)
    if code and not finding:
        shutil.copy(log, findings / f"{name}-{int(time.time())}.log")
        finding = [f"{name} ended with {code}: see the log in {findings}"]
    return executions, last(r"cov: (\d+)", text), finding[-1] if code else None


def run(program, name, flags):
    """Runs a target for its time, again after each finding."""
    (flags.out / "corpus" / name).mkdir(parents=True, exist_ok=True)
    end, executions, coverage, findings = time.monotonic() + flags.seconds, 0, 0, []
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    while len(findings) <= RESTARTS and (left := round(end - time.monotonic())) > 0:
        more, reached, finding = once(program, name, left, flags)
        executions, coverage = executions + more, max(coverage, reached)
        if finding is None:
            break
        findings.append(finding)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"{name:<15} {executions:>11} {cpu:>9.1f} {coverage:>9} {len(findings):>9}", flush=True)
    return findings


def main():
    flags = arguments()
    flags.out, flags.target_dir = flags.out.resolve(), flags.target_dir.resolve()
    known = driver("--list").split()
    if unknown := [name for name in flags.targets if name not in known]:
        sys.exit(f"there is no target {unknown[0]}; scripts/fuzz --list names all")
    program = build(flags)
    (flags.out / "findings").mkdir(parents=True, exist_ok=True)
    names = flags.targets or known
    driver("--samples", str(flags.out / "corpus"), *names)
    print(f"{'target':<15} {'executions':>11} {'CPU s':>9} {'edges':>9} {'findings':>9}", flush=True)
    findings = [finding for name in names for finding in run(program, name, flags)]
    print(*findings, sep="\n", end="\n" if findings else "")
    sys.exit(1 if findings else 0)


if __name__ == "__main__":
    main()
