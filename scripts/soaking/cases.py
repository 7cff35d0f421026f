"""Pipelines of scripts/soak that run again and again. Each takes a trial: a random source, folders and helpers."""

import os
import pathlib
import re
import signal
import time

from soaking import inputs, processes

# What a job of a plan leaves.
PART = re.compile(r"[0-9a-f]{16}(\.json|\.spm|\.rest\.spm)")


class Fault(Exception):
    """What a pipeline must not do."""


class Trial:
    """One run of one pipeline in an empty folder. A yardstick is a run of the same size with the same flags."""

    def __init__(self, soak, random, folder, scratch, is_yardstick):
        self.soak, self.random, self.folder, self.scratch = soak, random, folder, scratch
        self.is_yardstick = is_yardstick
        self.threads = 2 if is_yardstick else random.choice((1, 2))
        self.cell_points = 500 if is_yardstick else random.choice((60, 500, 20_000))
        self.outputs, self.audits, self.peaks, self.samples = set(), 0, {}, []

    def size(self, most):
        return most if self.is_yardstick else int(most ** self.random.uniform(0.25, 1))

    def family(self, families):
        return inputs.uniform if self.is_yardstick else self.random.choice(families)

    def file(self, name):
        """A file or folder that the pipeline may leave."""
        self.outputs.add(name)
        return self.folder / name

    def points(self, most, dims=2, families=inputs.ALL, kind=None, least=3):
        found = inputs.points(self.random, self.family(families), max(least, self.size(most)), dims)
        kind = kind or ("las" if self.is_yardstick else self.random.choice(("las", "txt", "npy")))
        path = self.file(f"points.{kind}")
        {"las": inputs.write_las, "txt": inputs.write_text, "npy": inputs.write_npy}[kind](path, found)
        self.given = found
        return path

    def start(self, commands, **redirected):
        """A pipe that runs, and the file of its messages."""
        messages = self.folder.parent / "messages"
        with open(messages, "wb") as errors:
            pipe = processes.Pipe(self.soak.meter, self.soak.programs, commands, self.folder, self.scratch,
                                  errors, **redirected)
        return pipe, messages

    def pipe(self, *commands, is_sampled=False, **redirected):
        """Runs a pipe, all of whose programs must succeed."""
        pipe, messages = self.start(commands, **redirected)
        sampler = processes.Sampler(self.soak.meter, pipe, 0.02) if is_sampled else None
        codes, peaks = pipe.wait()
        if sampler:
            self.samples += sampler.stop()
        said = processes.said(messages)
        if any(codes) or processes.PANIC in said:
            words = " | ".join(" ".join(map(str, command)) for command in commands)
            raise Fault(f"exit codes {codes} of {words}: {said[:2000]}")
        for name, peak in zip(pipe.names, peaks):
            self.peaks[name] = max(peak, self.peaks.get(name, 0))
        self.audits += sum("--audit" in command for command in commands)

    def finalize(self, *flags):
        return ["spfinalize", "-q", "--memory", self.soak.memory, "--temp-dir", self.scratch,
                "--threads", self.threads, "--cell-points", self.cell_points, *flags]

    def reduce(self, *flags):
        return ["spdelaunay2d", "-q", "--threads", self.threads, *flags]

    def mesh(self, points, name="mesh.spm"):
        mesh = self.file(name)
        self.pipe(self.finalize(points), self.reduce("-o", mesh))
        return mesh

    def check_folders(self):
        """The folder holds what was declared and the temporary folder nothing."""
        left = {entry.name for entry in self.folder.iterdir()} - self.outputs
        left |= {entry.name for entry in pathlib.Path(self.scratch).iterdir()}
        if left:
            raise Fault(f"files left: {sorted(left)}")


def audit(*flags):
    return ["spinfo", "-q", "--audit", *flags]


def plane(trial):
    points = trial.points(30_000)
    trial.pipe(trial.finalize(points), trial.reduce(), audit("--points", points))


def bulk(trial):
    """More points than the memory of spfinalize holds: they wait in temporary files."""
    points = trial.file("points.raw")
    inputs.write_raw(points, trial.random, trial.size(2_000_000))
    trial.pipe(trial.finalize("--raw", "u16le", points), trial.reduce(), audit())


def space(trial):
    points = trial.points(8_000, dims=3)
    reduce = ["spdelaunay3d", "-q", "--threads", trial.threads]
    trial.pipe(trial.finalize("--octree", points), reduce, audit("--points", points))


def raster(trial):
    mesh = trial.mesh(trial.points(15_000, families=inputs.AREAS))
    kind = trial.random.choice(("elevation", "slope", "hillshade"))
    trial.pipe(["spdem", "-q", "--columns", 300, "--kind", kind, mesh, "-o", trial.file("a.tif")])
    trial.pipe(["spdem", "-q", "--contours", 50, mesh, "-o", trial.file("a.geojson")])
    trial.pipe(audit(mesh))


def constrain(trial):
    points, lines = trial.points(6_000, families=inputs.AREAS), trial.file("lines.txt")
    inputs.write_lines(lines, trial.random, trial.given, 60 if trial.is_yardstick else trial.random.randrange(5, 60))
    flags = ["--kill", 200_000] if trial.random.random() < 0.3 else []
    constrain = ["spconstrain", "-q", "--lines", lines, "--temp-dir", trial.scratch, *flags]
    trial.pipe(trial.finalize(points), trial.reduce(), constrain, audit())


def spline(trial):
    points, spline = trial.points(1_500, least=50, families=inputs.AREAS[:1]), trial.file("a.spline.spm")
    trial.pipe(["splinefit", "fit", "-q", "--max-knots", 60, points, "-o", spline])
    trial.pipe(["splinefit", "eval", "-q", "--columns", 120, spline, "-o", trial.file("a.tif")])
    trial.pipe(audit(spline))


def configurations(trial):
    points = trial.points(900, least=30, families=inputs.AREAS)
    trial.pipe(["configgen", "-q", "--degree", trial.random.choice((1, 2, 3)), points], audit())


def diagram(trial):
    """Points of a small lattice in space and time: most are cospherical."""
    # Fewer could lie in a hyperplane.
    n, points = max(40, trial.size(500)), trial.file("p.txt")
    side = 5 if trial.is_yardstick else trial.random.randrange(2, 40)
    with open(points, "w") as file:
        for _ in range(n):
            file.write(" ".join(str(trial.random.randrange(side)) for _ in range(4)) + "\n")
    trial.pipe(["dd4", "-q", points], audit())


def molecule(trial):
    structure = trial.file("a.pdb")
    inputs.write_structure(structure, trial.random, trial.size(6_000))
    trial.pipe(["tess3", "-q", "--threads", trial.threads, structure], audit())
    for table, name in (("--sasa", "a.tsv"), ("--contact-areas", "a.tsv"), ("--filtration", "a.txt")):
        trial.pipe(["tess3", "-q", table, "--threads", trial.threads, structure, "-o", trial.file(name)])


def convert(trial):
    mesh = trial.mesh(trial.points(10_000, families=inputs.AREAS))
    text, back = trial.file("mesh.txt"), trial.file("back.txt")
    trial.pipe(["spconvert", "-q", mesh, "--to", "text", "-o", text])
    trial.pipe(["spconvert", "-q", text, "--to", "spm"], ["spconvert", "-q", "-", "--to", "text", "-o", back])
    if text.read_bytes() != back.read_bytes():
        raise Fault("a mesh differs after text and back")
    for ending in ("ply", "obj", "vtu", "xml", "smb"):
        output = trial.file(f"mesh.{ending}")
        trial.pipe(["spconvert", "-q", "--temp-dir", trial.scratch, mesh, "-o", output])
    trial.pipe(audit(mesh))


def plan(trial):
    """Many jobs, one after the other, and the mesh that their manifest names."""
    points, plan, parts = trial.points(8_000, families=inputs.AREAS, kind="las"), trial.file("plan"), trial.file("d")
    manifest = trial.file("mesh.json")
    trial.pipe(["spfinalize", "-q", "--plan", plan, "--leaf-points", 2_000, points])
    nodes = trial.folder.parent / "nodes"
    with open(nodes, "wb") as file:
        trial.pipe(["spnode", "-q", "list", plan], stdout=file)
    for row in nodes.read_text().splitlines():
        trial.pipe(["spnode", "-q", "run", plan, row.split("\t")[0], "-d", parts, "--threads", trial.threads])
    trial.pipe(["spnode", "-q", "collect", plan, "-d", parts, "-o", manifest])
    trial.pipe(["spconvert", "-q", manifest, "--to", "spm"], audit("--points", points))
    files = [path for path in parts.rglob("*") if path.is_file()]
    if left := [path.name for path in files if not PART.fullmatch(path.name)]:
        raise Fault(f"files left by jobs: {sorted(left)}")


def heights(trial):
    points = trial.points(8_000, families=inputs.AREAS, kind="las")
    mesh = trial.mesh(points)
    trial.pipe(["spheight", "-q", "--ground", mesh, "--temp-dir", trial.scratch, points, "-o", trial.file("h.laz")])
    trial.pipe(["spcanopy", "-q", "--ground", mesh, "--columns", 200, points, "-o", trial.file("c.tif")])
    trial.pipe(audit(mesh))


def deadly():
    """Signals that end a program: those ignored here, such as SIGHUP under nohup, are ignored by programs, too."""
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, [])
    numbers = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP)
    return [number for number in numbers if number not in blocked and signal.getsignal(number) != signal.SIG_IGN]


def killed(trial):
    """A program of a pipe is killed at any time: no file is left but a mesh that is whole. Then it runs again."""
    points, mesh = trial.file("points.raw"), trial.file("mesh.spm")
    inputs.write_raw(points, trial.random, 300_000)
    commands = [trial.finalize("--raw", "u16le", points), trial.reduce("-o", mesh)]
    pipe, messages = trial.start(commands)
    time.sleep(trial.random.uniform(0, 0.5))
    os.kill(trial.random.choice(pipe.processes).pid, trial.random.choice(deadly()))
    codes, _ = pipe.wait()
    if processes.PANIC in (said := processes.said(messages)):
        raise Fault(f"a panic: {said[:2000]}")
    if mesh.exists():
        trial.pipe(audit(mesh))
    elif not any(codes):
        raise Fault("a pipe succeeded without its mesh")
    trial.check_folders()
    trial.pipe(*commands)
    trial.pipe(audit(mesh))


def sweep(trial):
    """Thousands of structures in one process, whose memory and descriptors are sampled."""
    folder, listed = trial.file("in"), trial.file("list")
    folder.mkdir()
    for number in range(20):
        inputs.write_structure(folder / f"{number}.pdb", trial.random, 10 * (number + 1))
    names = [folder / f"{number}.pdb" for number in range(20)]
    for number in range(20, 2_000):
        names.append(folder / f"{number}.pdb")
        names[-1].hardlink_to(names[number % 20])
    listed.write_text("".join(f"{name}\n" for name in names))
    trial.pipe(["tess3", "-q", "--threads", trial.threads, "--lof", listed, "--out-dir", trial.file("out")],
               is_sampled=True)
    check_sweep(trial, trial.folder / "out", len(names))


def check_sweep(trial, out, count):
    """All meshes and the summary are there, and nothing else; those of one structure are the same."""
    expected = {"summary.tsv", *(f"{number}.spm" for number in range(count))}
    if wrong := expected ^ {entry.name for entry in out.iterdir()}:
        raise Fault(f"missing or too many in a sweep: {sorted(wrong)}"[:2000])
    for number in range(20, count):
        if (out / f"{number}.spm").read_bytes() != (out / f"{number % 20}.spm").read_bytes():
            raise Fault(f"meshes {number} and {number % 20} of one structure differ")
    trial.pipe(audit(out / f"{trial.random.randrange(count)}.spm"))


ALL = [plane, bulk, space, raster, constrain, spline, configurations, diagram, molecule, convert, plan, heights,
       killed, sweep]
