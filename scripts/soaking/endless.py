"""Pipes of scripts/soak that run for the whole time; the library runs for a twentieth of it."""

import random
import subprocess
import threading
import time

from soaking import inputs, processes

INTERVALS = 300
POINTS_PER_SECOND = 3000


class Endless(threading.Thread):
    """A pipe that is fed or emptied slowly; its programs are sampled."""

    outputs = set()
    # Share of the samples to skip before memory is compared.
    skipped = 0

    def __init__(self, soak, folder, seconds):
        super().__init__(daemon=True)
        self.soak, self.seconds, self.fault, self.samples, self.audits = soak, seconds, None, [], 0
        self.folder, self.scratch = folder / "work", folder / "temporary"
        for made in (self.folder, self.scratch):
            made.mkdir(parents=True)
        self.start()

    def run(self):
        try:
            with open(self.folder.parent / "messages", "wb") as self.errors:
                self.work()
            left = {path.name for folder in (self.scratch, self.folder) for path in folder.iterdir()} - self.outputs
            if left:
                raise RuntimeError(f"files left: {left}")
            if processes.PANIC in processes.said(self.folder.parent / "messages"):
                raise RuntimeError("a panic")
        except Exception as error:  # the thread reports to the one that started it
            said = processes.said(self.folder.parent / "messages")
            self.fault = f"{type(error).__name__} {error}: {said[:2000]}"

    def pipe(self, *commands, **redirected):
        return processes.Pipe(self.soak.meter, self.soak.programs, commands, self.folder, self.scratch, self.errors,
                              **redirected)

    def sampled(self, *pipes):
        return [processes.Sampler(self.soak.meter, pipe, max(0.1, self.seconds / INTERVALS)) for pipe in pipes]

    def finish(self, samplers, *pipes):
        """Waits for the pipes, the last of which audits."""
        codes = [code for pipe in pipes for code in pipe.wait()[0]]
        self.samples = [samples for sampler in samplers for samples in sampler.stop()]
        for samples in self.samples:
            samples.skip(self.skipped)
        if any(codes):
            raise RuntimeError(f"exit codes {codes}")
        self.audits += 1


class Strip(Endless):
    """A stream of points without end, which this script writes: text, binary, triangles, audit.

    Flat triangles at the sides of the strip have large circles, so that they are not final for long. Their number
    grows as the square root of the length: by two fifths in the second half."""

    name, skipped = "endless strip", 0.5

    def work(self):
        pipe = self.pipe(["spconvert", "-q", "--to", "spm", "-"], ["spdelaunay2d", "-q", "--threads", "2"],
                         ["spinfo", "-q", "--audit"], stdin=subprocess.PIPE)
        samplers, start = self.sampled(pipe), time.monotonic()
        with pipe.processes[0].stdin as sink:
            for written, tags, text in inputs.strip(random.Random(self.soak.seed)):
                sink.write(text.encode())
                passed = time.monotonic() - start
                if passed > self.seconds:
                    break
                time.sleep(max(0, written / POINTS_PER_SECOND - passed))
            sink.write(inputs.end(written, tags).encode())
        self.finish(samplers, pipe)


class Tiles(Endless):
    """Many tiles whose mesh is read slowly, so that the programs live for the whole time."""

    name = "endless tiles"
    SIDE, TILE_POINTS = 16, 1500

    def tiles(self):
        source, side = random.Random(self.soak.seed), 1 << 16
        for number in range(self.SIDE ** 2):
            x, y = number % self.SIDE * side, number // self.SIDE * side
            path = self.folder.parent / f"{number}.las"
            inputs.write_las(path, [(x + source.randrange(side), y + source.randrange(side), source.randrange(900))
                                    for _ in range(self.TILE_POINTS)])
            yield path

    def work(self):
        tiles = list(self.tiles())
        finalize = ["spfinalize", "-q", "--memory", self.soak.memory, "--temp-dir", self.scratch,
                    "--cell-points", 200, *tiles]
        programs = [finalize, ["spdelaunay2d", "-q", "--threads", "2"]]
        first = self.pipe(*programs, stdout=subprocess.PIPE)
        total = sum(len(part) for part in iter(lambda: first.processes[-1].stdout.read(1 << 16), b""))
        first.processes[-1].stdout.close()
        if any(first.wait()[0]):
            raise RuntimeError("the first pipe failed")
        made = self.pipe(*programs, stdout=subprocess.PIPE)
        proved = self.pipe(["spinfo", "-q", "--audit"], stdin=subprocess.PIPE)
        samplers, start, read = self.sampled(made, proved), time.monotonic(), 0
        with made.processes[-1].stdout as source, proved.processes[0].stdin as sink:
            for part in iter(lambda: source.read(1 << 12), b""):
                sink.write(part)
                read += len(part)
                time.sleep(max(0, start + self.seconds * read / total - time.monotonic()))
        self.finish(samplers, made, proved)


class Library(Endless):
    """The library in one process: the example that fuzzes the kernel in space, one set after the other, of many
    sizes."""

    name, outputs, skipped = "library", {"target"}, 0.5

    def work(self):
        seconds = max(10, round(self.seconds / 20))
        pipe = self.pipe(["examples/fuzz3", "--seconds", seconds, "--seed", self.soak.seed, "--threads", 1])
        self.seconds = seconds
        samplers = self.sampled(pipe)
        self.finish(samplers, pipe)


ALL = [Strip, Tiles, Library]
