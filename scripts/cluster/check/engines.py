"""The ways to run a plan: Snakemake on this machine and on Slurm, job arrays, and GNU parallel."""

import os
import pathlib
import shutil
import subprocess

import compare

CLUSTER = pathlib.Path(__file__).resolve().parents[1]
LIMIT_S = 3600

# Runs spnode, and spoils runs of nodes that files in a folder name: KIND.NODE.COUNT holds the value.
WRAPPER = """#!/bin/sh
words=$*
if [ "$1" = run ]; then
    for order in "{orders}"/*.*.*; do
        [ -f "$order" ] || continue
        name=${{order##*/}} kind= number=
        kind=${{name%%.*}} number=${{name#*.}} number=${{number%%.*}}
        case " ${{words%% -d *}} " in *" $number "*) ;; *) continue ;; esac
        mv "$order" "{orders}/done/" 2> /dev/null || continue
        value=$(cat "{orders}/done/$name")
        case $kind in
            kill)
                # In the middle of its work: as soon as it has opened a file.
                before=$(find "{parts}" 2> /dev/null)
                "{real}" "$@" & child=$!
                while [ "$(find "{parts}" 2> /dev/null)" = "$before" ] && kill -0 $child 2> /dev/null; do :; done
                kill -9 $child 2> /dev/null
                wait $child
                code=$?
                echo $code > "{orders}/done/$name.code"
                exit $code ;;
            disk) trap '' XFSZ && ulimit -f "$value" && exec "{real}" "$@" ;;
        esac
    done
fi
exec "{real}" "$@"
"""


class Work:
    """A folder in which an engine runs."""

    def __init__(self, folder, survey, snakemake):
        self.folder = folder
        self.survey = survey
        self.results = folder / "results"
        self.orders = folder / "orders"
        (self.orders / "done").mkdir(parents=True)
        self.results.mkdir()
        (folder / "bin").mkdir()
        wrapper = folder / "bin" / "spnode"
        wrapper.write_text(WRAPPER.format(orders=self.orders, parts=self.parts, real=survey.programs / "spnode"))
        wrapper.chmod(0o755)
        paths = [folder / "bin", survey.programs, snakemake / "bin", os.environ["PATH"]]
        self.environment = {**os.environ, "PATH": os.pathsep.join(map(str, paths))}

    @property
    def plan(self):
        return self.results / "plan.json"

    @property
    def parts(self):
        return self.results / "parts"

    @property
    def mesh(self):
        return self.results / "mesh.json"

    def file_of(self, node, ending):
        """A file of the node with this number."""
        return compare.file_of(self.parts, self.survey.nodes(self.plan)[node][5], ending)

    def complete(self):
        """Numbers of the nodes that have reports."""
        return [int(node[0]) for node in self.survey.nodes(self.plan) if self.has_report(node[5])]

    def has_report(self, name):
        return compare.file_of(self.parts, name, ".json").exists()

    def remove(self):
        shutil.rmtree(self.folder)

    def order(self, kind, node, value, count=1):
        """Spoils the next runs of a node."""
        for i in range(count):
            (self.orders / f"{kind}.{node}.{i}").write_text(str(value))

    def spoiled(self):
        """How many runs were spoiled, and the exit codes of those that were killed."""
        names = [path for path in (self.orders / "done").iterdir() if path.suffix != ".code"]
        codes = [int(path.read_text()) for path in (self.orders / "done").glob("*.code")]
        return len(names), codes

    def start(self, command, **more):
        log = open(self.folder / "log.txt", "ab")
        return subprocess.Popen(
            list(map(str, command)), cwd=self.folder, env=self.environment, stdout=log, stderr=log,
            start_new_session=True, **more,
        )  # fmt: skip

    def run(self, command):
        """The exit code, and what the command says, which also goes to log.txt."""
        log = self.folder / "log.txt"
        before = log.stat().st_size if log.exists() else 0
        code = self.start(command).wait(LIMIT_S)
        return code, log.read_bytes()[before:].decode(errors="replace")


def lacking(*programs):
    return [name for name in programs if shutil.which(name) is None]


class Snakemake:
    """Snakemake, with two jobs on this machine or with jobs of Slurm."""

    makes_rasters = True

    def __init__(self, slurm):
        self.on_slurm = slurm
        self.name = "Snakemake on Slurm" if slurm else "Snakemake"

    def missing(self, snakemake):
        if not (snakemake / "bin" / "snakemake").exists():
            return f"no Snakemake in {snakemake}: scripts/cluster/environment {snakemake}"
        if lacking("gdalbuildvrt", "gdal_translate", "gdalinfo"):
            return "no GDAL: apt install gdal-bin"
        return None

    def prepare(self, work):
        """Writes what the command refers to."""
        names = work.folder / "tiles.txt"
        names.write_text("".join(f"{tile}\n" for tile in work.survey.tiles))

    def command(self, work, *more):
        survey = work.survey
        settings = {
            "tiles": f"@{work.folder / 'tiles.txt'}",
            "results": "results",
            "leaf_points": survey.leaf_points,
            "batch_points": 2 * survey.leaf_points,
            "filters": " ".join(survey.filters),
            "dem_step": survey.step,
            "contours": survey.interval,
            "threads": 1,
        }
        where = ["--jobs", 2]
        if self.on_slurm:
            # There is no accounting here, and jobs are short.
            where = ["--jobs", 8, "--executor", "slurm", "--slurm-status-command", "squeue"]
            where += ["--slurm-init-seconds-before-status-checks", 1, "--seconds-between-status-checks", 1]
        return [
            "snakemake", "--snakefile", CLUSTER / "Snakefile", "--profile", CLUSTER / "profile", *where,
            "--latency-wait", 5, *more, "--config", *(f"{key}={value}" for key, value in settings.items()),
        ]  # fmt: skip


class Arrays:
    """Job arrays of Slurm."""

    name = "slurm-array"
    makes_rasters = False

    def missing(self, _):
        return None

    def prepare(self, work):
        work.survey.plan(work.plan)

    def command(self, work):
        return [
            CLUSTER / "slurm-array", work.plan, "-d", work.parts, "-o", work.mesh, "--wait", "--threads", 1,
            "--batch-points", work.survey.leaf_points, "--verify",
        ]  # fmt: skip


class Parallel:
    """GNU parallel."""

    name = "GNU parallel"
    makes_rasters = False

    def missing(self, _):
        return "no GNU parallel: apt install parallel" if lacking("parallel") else None

    def prepare(self, work):
        work.survey.plan(work.plan)

    def command(self, work):
        return [
            CLUSTER / "parallel", work.plan, "-d", work.parts, "-o", work.mesh,
            "--batch-points", 2 * work.survey.leaf_points, "--parallel", "--jobs 2", "--verify",
        ]  # fmt: skip
