"""Random failures of spnode on small data: no point may be lost or doubled."""

import concurrent.futures
import os
import random
import subprocess
import time

import compare
import failures

RUNS_MAX = 3
# Shares of runs of a node that are killed or find a full disk, and of those behind which a file is damaged.
KILLED, FULL, DAMAGED = 0.2, 0.1, 0.25


class Trial:
    """One run of a plan in which much goes wrong."""

    def __init__(self, survey, work, name, seconds):
        self.survey, self.work, self.seconds = survey, work, seconds
        self.random = random.Random(name)
        self.counts = {"killed": 0, "full disk": 0, "damaged": 0}
        self.complete = []

    def disorder(self):
        """Runs all nodes, two at a time, with failures; nobody looks at exit codes."""
        nodes = self.survey.nodes(self.work.plan)
        for stage in sorted({int(node[1]) for node in nodes}):
            numbers = [int(node[0]) for node in nodes if int(node[1]) == stage]
            self.random.shuffle(numbers)
            orders = [(number, self.random.random(), self.random.random()) for number in numbers]
            with concurrent.futures.ThreadPoolExecutor(2) as pool:
                list(pool.map(lambda order: self.run(*order), orders))
            self.complete += numbers
            for _ in numbers:
                if self.random.random() < DAMAGED:
                    self.damage()

    def run(self, number, chance, share):
        command = ["spnode", "run", str(self.work.plan), str(number), "-d", str(self.work.parts)]
        is_full = KILLED <= chance < KILLED + FULL
        if is_full:
            # Blocks of 512 bytes; without the signal, writes fail as on a full disk.
            command = ["sh", "-c", f"trap '' XFSZ; ulimit -f {int(share * 40)}; exec \"$@\"", "-", *command]
        process = subprocess.Popen(
            command, env=self.work.environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            restore_signals=True,
        )  # fmt: skip
        if chance < KILLED:
            try:
                process.wait(share * 1.2 * self.seconds)
            except subprocess.TimeoutExpired:
                process.kill()
        code = process.wait()
        self.counts["killed"] += chance < KILLED and code != 0
        self.counts["full disk"] += is_full and code != 0

    def damage(self):
        """Damages or deletes a file of a node that was run."""
        node = self.random.choice(self.complete)
        files = [failures.part_of, failures.residual_of, failures.report_of]
        path = self.random.choice(files)(self.work, node)
        share = self.random.random()
        act = self.random.choice([failures.flip, failures.cut, lambda path, _: path.unlink()])
        # A run that was killed may have left no file.
        if path.exists() and path.stat().st_size > 0:
            act(path, share)
            self.counts["damaged"] += 1

    def repair(self, engine):
        """The usual command until it succeeds; returns how often it ran."""
        for run in range(1, RUNS_MAX + 1):
            code, said = self.work.run(engine.command(self.work))
            if code == 0:
                return run
        last = " / ".join(said.strip().splitlines()[-3:])
        raise compare.Difference(f"exits with {code} after {RUNS_MAX} runs: {last}")


def run(survey, engine, fresh, count, seed, say):
    """Runs trials; returns how many of them lost or doubled something or could not be repaired."""
    work = fresh("calm")
    engine.prepare(work)
    started = time.monotonic()
    nodes = [node[0] for node in survey.nodes(work.plan)]
    for number in nodes:
        command = ["spnode", "-q", "run", work.plan, number, "-d", work.parts]
        subprocess.run(command, env=work.environment, check=True)
    seconds = (time.monotonic() - started) / len(nodes)
    total, bad = {}, 0
    for number in range(count):
        work = fresh(f"trial-{number}")
        engine.prepare(work)
        trial = Trial(survey, work, f"{seed} {number}", seconds)
        trial.disorder()
        try:
            runs = trial.repair(engine)
            survey.check(work.mesh, work.plan, work.parts)
        except (compare.Difference, OSError, ValueError, KeyError) as error:
            bad += 1
            say(f"trial {number} of seed {seed}: {error}; {trial.counts}; see {work.folder}")
            continue
        for name, found in {**trial.counts, "runs": runs}.items():
            total[name] = total.get(name, 0) + found
        failures_of = ", ".join(f"{found} {name}" for name, found in total.items())
        if (number + 1) % 10 == 0 or number + 1 == count:
            say(f"{number + 1} trials, {len(nodes)} nodes each: {failures_of}; {bad} bad")
        work.remove()
    return bad
