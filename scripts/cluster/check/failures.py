"""What goes wrong in long runs, and whether the same command again repairs it."""

import dataclasses
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time

import compare

WAIT_S = 300


# --- Damage ---------------------------------------------------------------------------------------------------


def flip(path, at=0.6):
    """Flips a bit."""
    data = bytearray(path.read_bytes())
    data[int(len(data) * at)] ^= 0x10
    path.write_bytes(data)


def cut(path, share=0.5):
    os.truncate(path, int(path.stat().st_size * share))


def spoil(path):
    """Spoils the points of a LAZ file in its middle, and leaves its header."""
    data = bytearray(path.read_bytes())
    middle = len(data) // 2
    data[middle : middle + 64] = bytes(byte ^ 0x55 for byte in data[middle : middle + 64])
    path.write_bytes(data)


def part_of(work, node):
    return work.file_of(node, ".spm")


def residual_of(work, node):
    return work.file_of(node, ".rest.spm")


def report_of(work, node):
    return work.file_of(node, ".json")


def made(work, node):
    """When a node was made."""
    try:
        return report_of(work, node).stat().st_mtime_ns
    except FileNotFoundError:
        return None


# --- Checks of one engine -------------------------------------------------------------------------------------


class Failures:
    """Runs an engine through failures; `fresh(name)` makes a folder of work."""

    def __init__(self, survey, engine, fresh, say):
        self.survey, self.engine, self.fresh, self.say = survey, engine, fresh, say
        self.base = None

    def expect(self, holds, message):
        if not holds:
            raise compare.Difference(f"{self.engine.name}: {message}")

    def work(self, name):
        work = self.fresh(name)
        self.engine.prepare(work)
        return work

    def finish(self, work, what, before=None, nodes=()):
        """Runs the command (again): it must succeed, make the nodes again, and the mesh must be that of the pipe."""
        code, said = work.run(self.engine.command(work))
        self.expect(code == 0, f"{what}: the command again exits with {code}; see {work.folder / 'log.txt'}")
        for node in nodes:
            self.expect(made(work, node) != before[node], f"{what}: node {node} was not made again")
        self.survey.check(work.mesh, work.plan, work.parts)
        return said

    def leaves(self, name):
        """Work whose leaves are complete, and the numbers of the leaves."""
        work = self.work(name)
        numbers = [int(node[0]) for node in self.survey.nodes(work.plan) if node[1] == "0"]
        command = ["spnode", "run", work.plan, *numbers, "-d", work.parts]
        code, _ = work.run(command)
        self.expect(code == 0, f"the leaves exit with {code}")
        return work, numbers

    def damaged(self, what, state, damage):
        """Damages files of a leaf in a state of work, then runs the command."""
        work, numbers = self.leaves(what.replace(" ", "-"))
        if state == "complete":
            self.finish(work, what)
        node = numbers[len(numbers) // 2]
        before = {node: made(work, node)}
        damage(work, node)
        self.finish(work, what, before, [node])
        self.say(f"{what}: node {node} was made again")

    def damage(self):
        """Files that are damaged or gone."""
        self.damaged("a residual with a flipped bit", "leaves", lambda work, n: flip(residual_of(work, n)))
        self.damaged("a residual cut off", "leaves", lambda work, n: cut(residual_of(work, n)))
        self.damaged("a residual deleted", "leaves", lambda work, n: residual_of(work, n).unlink())
        self.damaged("a part deleted", "complete", lambda work, n: part_of(work, n).unlink())
        self.damaged("a part with a flipped bit", "complete", lambda work, n: flip(part_of(work, n)))
        self.damaged("a part cut off", "complete", lambda work, n: cut(part_of(work, n)))
        self.damaged("a report deleted", "complete", lambda work, n: report_of(work, n).unlink())
        self.damaged("a report cut off", "complete", lambda work, n: cut(report_of(work, n)))

    def killed_workers(self):
        """A leaf and the root are killed in each attempt of a run; the next run finishes."""
        what = "workers killed"
        work = self.work("killed-workers")
        if not work.plan.exists():
            self.survey.plan(work.plan)
        numbers = [int(node[0]) for node in self.survey.nodes(work.plan)]
        for node in (numbers[3], numbers[-1]):
            work.order("kill", node, "", 3)
        runs = 0
        while runs < 3:
            runs += 1
            code, _ = work.run(self.engine.command(work))
            if code == 0:
                break
        count, codes = work.spoiled()
        self.expect(code == 0, f"{what}: still exits with {code} after {runs} runs; see {work.folder / 'log.txt'}")
        died = sum(c == 128 + signal.SIGKILL for c in codes)
        self.expect(died > 0, f"{what}: none was, exit codes {codes}")
        self.survey.check(work.mesh, work.plan, work.parts)
        self.say(f"{what}: {died} of {count} runs died, {runs} runs of the command")

    def full_disk(self):
        """The folder of the parts is full in the middle of the upper stages."""
        what = "a full disk"
        work, _ = self.leaves("full-disk")
        used = sum(path.stat().st_blocks * 512 for path in work.parts.rglob("*") if path.is_file())
        aside = work.folder / "aside"
        work.parts.rename(aside)
        work.parts.mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", f"size={used + 65536}", "tmpfs", work.parts]
        if os.geteuid() != 0 or subprocess.run(mount, capture_output=True).returncode != 0:
            work.parts.rmdir()
            aside.rename(work.parts)
            return self.limited_files(work, what)
        try:
            shutil.copytree(aside, work.parts, dirs_exist_ok=True)
            code, said = work.run(self.engine.command(work))
            self.expect(code != 0, f"{what}: the command exits with 0")
            self.expect("No space left" in said, f"{what}: no message says so; see {work.folder / 'log.txt'}")
            subprocess.run(["mount", "-o", "remount,size=50%", work.parts], check=True)
            self.finish(work, what)
        finally:
            subprocess.run(["umount", work.parts], capture_output=True)
        self.say(f"{what}: exit code {code}, then repaired")

    def limited_files(self, work, what):
        """Without tmpfs: files of a node must not be larger than 1 KB."""
        root = int(self.survey.nodes(work.plan)[-1][0])
        work.order("disk", root, 2, 3)
        code, _ = work.run(self.engine.command(work))
        self.expect(code != 0, f"{what}: the command exits with 0")
        self.finish(work, what)
        self.say(f"{what} (files of limited size): exit code {code}, then repaired")

    def killed_engine(self):
        """The engine is killed with all that it started, files are damaged meanwhile, and it is run again."""
        what = "the engine killed"
        work = self.work("killed-engine")
        process = work.start(self.engine.command(work))
        end = time.monotonic() + WAIT_S
        while process.poll() is None and len(list(work.parts.glob("??/*.json"))) < 3:
            self.expect(time.monotonic() < end, f"{what}: no node is complete after {WAIT_S} s")
            time.sleep(0.01)
        self.expect(process.poll() is None, f"{what}: it ended before, with {process.poll()}")
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        complete = work.complete()
        part_of(work, complete[0]).unlink()
        flip(residual_of(work, complete[1]))
        before = {node: made(work, node) for node in complete[:2]}
        code, said = work.run(self.engine.command(work))
        if code != 0:
            self.expect("--unlock" in said, f"{what}: exits with {code}; see {work.folder / 'log.txt'}")
            code, _ = work.run(self.engine.command(work, "--unlock"))
            self.expect(code == 0, f"{what}: --unlock exits with {code}")
        self.finish(work, what, before, complete[:2])
        self.say(f"{what} after {len(complete)} nodes, a part deleted and a residual damaged: repaired")
        return work

    def bad_tile(self):
        """A tile whose header is right and whose points are not: it alone fails, is named, and is replaced later."""
        what = "a bad tile"
        work = self.work("bad-tile")
        tiles = work.folder / "tiles"
        tiles.mkdir()
        own = dataclasses.replace(self.survey, tiles=[pathlib.Path(shutil.copy2(tile, tiles)) for tile in self.survey.tiles])
        bad = own.tiles[len(own.tiles) // 2]
        whole = bad.read_bytes()
        spoil(bad)
        own.plan(work.plan)
        code, said = work.run(self.engine.command(work))
        self.expect(code != 0, f"{what}: the command exits with 0")
        self.expect(str(bad) in said.split("failed: ")[-1], f"{what}: it is not named; see {work.folder / 'log.txt'}")
        reads = [node for node in json.loads(work.plan.read_text())["nodes"] if own.tiles.index(bad) in node["files"]]
        missing = [node for node in own.nodes(work.plan) if node[1] == "0" and not work.has_report(node[5])]
        self.expect(len(missing) == len(reads), f"{what}: {len(missing)} leaves are not complete, {len(reads)} read it")
        bad.write_bytes(whole)
        own.plan(work.plan)
        self.finish(work, what)
        self.say(f"{what}: named, and {len(reads)} leaves that read it failed alone; repaired after planning again")
