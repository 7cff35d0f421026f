"""Jobs: the pipes that are tortured, with their inputs, and the names of what they write."""

import dataclasses
import re
import shlex


@dataclasses.dataclass(frozen=True)
class Job:
    """Programs in a pipe. Inputs are in the folder in/, outputs in out/, both below the current folder.

    `to_file` ends the last program's command line if it writes files, `to_stdout` if it writes to stdout;
    None if it cannot. `fed` is an input that comes through stdin. `needs` are inputs that no argument names.
    """

    name: str
    pipe: str
    to_file: str | None
    to_stdout: str | None = None
    fed: str = ""
    needs: tuple = ()
    # Whether the output is a pattern of names, and not the name of a file.
    is_pattern: bool = False

    @property
    def stages(self):
        return [shlex.split(stage) for stage in self.pipe.split(" | ")]

    @property
    def tools(self):
        return [stage[0] for stage in self.stages]

    def commands(self, is_to_file=True):
        """The command lines of all programs, without the folder of the programs."""
        commands = [[*stage, "--quiet"] for stage in self.stages]
        commands[-1] += shlex.split((self.to_file if is_to_file else self.to_stdout) or "")
        return commands

    @property
    def is_to_file_only(self):
        return self.to_stdout is None

    @property
    def is_to_stdout_only(self):
        return self.to_file is None

    def inputs(self, stage):
        """Names of files in in/ that a program reads, in order; that on stdin is "-"."""
        found = [*self.stages[stage], *(shlex.split(self.to_file or "") if self.is_last(stage) else [])]
        names = [name for argument in found for name in re.findall(r"^in/([\w.]+)$", argument)]
        return names + (["-"] if self.fed and stage == 0 else [])

    def outputs(self):
        """Files below the current folder that arguments name, in order; neither folders nor patterns."""
        named = re.findall(r"(?<!\S)out/[\w.]+\.\w+", f"{self.pipe} {self.to_file or ''}")
        return [] if self.is_pattern else named

    def all_inputs(self):
        """Names of everything in in/ that must be there."""
        named = [name for stage in range(len(self.stages)) for name in self.inputs(stage) if name != "-"]
        return dict.fromkeys([*named, *self.needs, *([self.fed] if self.fed else [])])

    def is_last(self, stage):
        return stage == len(self.stages) - 1


CLUSTER = ("tile.las", "east.las")

JOBS = [
    # Terrain.
    Job(
        "ground",
        "spfinalize --keep-class 2 in/tile.laz in/east.laz | spdelaunay2d --duplicates lowest",
        "-o out/ground.spm",
        "",
    ),
    Job("text", "spfinalize in/points.txt | spdelaunay2d | spdem --step 2", "-o out/text.tif", ""),
    Job(
        "fed",
        "spfinalize - --cell-points 500 | spdelaunay2d --threads 1 --compress",
        "-o out/fed.spm",
        "",
        fed="points.txt",
    ),
    Job("zipped", "spfinalize in/points.txt.gz --memory 64M --spool always", "-o out/zipped.spm", ""),
    Job("mesh", "spdelaunay2d --threads 4 in/points.spm", "-o out/mesh.spm", ""),
    Job("raster", "spdem --step 1 --cog in/ground.spm", "-o out/raster.tif", ""),
    Job("grid", "spdem --step 1 --kind slope --fill 3 in/ground.spm", "-o out/grid.asc", "--format asc"),
    Job("sheets", "spdem --step 1 --tiles 3,2 in/ground.spm", "-o out/sheet.tif", is_pattern=True),
    Job("contours", "spdem --contours 1 --smooth in/ground.spm", "-o out/lines.geojson", ""),
    Job("heights", "spheight --ground in/ground.spm in/tile.laz in/east.laz --name Height", "--out-dir out"),
    Job(
        "height", "spfinalize in/tile.las | spdelaunay2d | spheight --ground - in/east.las", "-o out/east.laz"
    ),
    Job("classes", "spground in/tile.laz in/east.laz --report out/found.json", "--out-dir out"),
    Job("volumes", "spdiff in/ground.spm --levels 0:400:5", "-o out/volumes.tsv", ""),
    Job("canopy", "spcanopy --ground in/ground.spm in/tile.laz --step 2", "-o out/canopy.tif", ""),
    Job(
        "lines",
        "spconstrain --lines in/lines.geojson --lines in/lines.gpkg --kill 40 in/ground.spm"
        " --report out/changes.tsv",
        "-o out/lines.spm",
        "",
    ),
    Job(
        "breaklines",
        "spfinalize in/tile.laz | spdelaunay2d | spconstrain --lines in/lines.txt | spdem --step 2",
        "-o out/breaklines.tif",
        "",
    ),
    Job("simple", "spsimplify --tolerance 1 in/ground.spm", "-o out/simple.spm", ""),
    Job("levels", "spsimplify --levels 0.5,2 in/ground.spm", "--out-dir out/levels"),
    # A cluster.
    Job("plan", "spfinalize in/tile.las in/east.las --leaf-points 1000 --plan out/plan.json", ""),
    Job("nodes", "spnode run in/plan.json {nodes}", "-d out/parts", needs=CLUSTER),
    Job("collect", "spnode collect in/plan.json -d in/parts", "-o out/mesh.json", needs=("parts", *CLUSTER)),
    Job("listed", "spnode list in/plan.json", None, "", needs=CLUSTER),
    Job("parts", "spdem --step 2 in/mesh.json", "-o out/parts.tif", "", needs=("parts",)),
    # Molecules and space.
    Job("atoms", "tess3 in/atoms.cif", "-o out/atoms.spm", ""),
    Job("contacts", "tess3 in/atoms.cif.gz --contact-areas --between residues", "-o out/contacts.tsv", ""),
    Job("areas", "tess3 in/atoms.pdb --sasa", "-o out/areas.parquet", "--format parquet"),
    Job("surface", "tess3 in/peptide.pdb.gz --sasa --probe 0 --resolution 2", "-o out/surface.ply"),
    Job("sweep", "tess3 in/atoms.cif in/atoms.pdb in/peptide.pdb.gz --threads 2", "--out-dir out/sweep"),
    Job("space", "spfinalize --octree in/cloud.xyz --cell-points 600 | spdelaunay3d", "-o out/cloud.spm", ""),
    Job("solid", "spdelaunay3d --threads 4 in/cloud.points.spm", "-o out/solid.spm", ""),
    # Space and time.
    Job("diagram", "dd4 in/points4.txt", "-o out/diagram.spm", ""),
    Job("isosurface", "dd4 in/volumes.nrrd --slice 1.5 --isosurface 420", "-o out/half.ply", ""),
    Job("stages", "dd4 in/series.nii.gz --count 4000 --time-scale 0.01 --memory 17.5M", "-o out/stages.spm", ""),
    Job("series", "dd4 in/series.nii.gz --count 300 | spinfo --audit", None, ""),
    # Splines.
    Job("spline", "splinefit fit --max-knots 60 in/tile.laz", "-o out/tile.spline.spm", ""),
    Job(
        "knots",
        "configgen --degree 1 --boundary pulled-apart in/knots.txt | splinefit fit --knots - in/points.txt",
        "-o out/knots.spline.spm",
        "",
    ),
    Job("values", "splinefit eval in/spline.spm --step 2", "-o out/values.tif"),
    Job("sites", "splinefit eval in/spline.spm --at in/knots.txt", "-o out/sites.npy"),
    Job("matrix", "splinefit eval in/spline.spm --collocation --at in/knots.txt", "-o out/matrix.npz"),
    Job("control", "splinefit mesh in/spline.spm", "-o out/control.svg"),
    Job("configurations", "configgen --degree 2 in/knots.txt", "-o out/knots.spm", ""),
    # Pictures, reports and other formats.
    Job("picture", "spview in/ground.spm", "-o out/ground.png", ""),
    Job(
        "snapshots",
        "spview --tee --snapshot every=700 in/points.spm -o out/%04d.png | spdelaunay2d",
        "-o out/mesh.spm",
    ),
    Job("page", "spview in/ground.spm", "-o out/page.html", "--format html"),
    Job("report", "spfinalize in/tile.laz | spdelaunay2d | spinfo --audit --points in/tile.laz", None, ""),
    Job("space-report", "spinfo --audit in/cloud.spm", None, ""),
    Job("ply", "spfinalize in/tile.laz | spdelaunay2d | spconvert --to ply", "-o out/mesh.ply", ""),
    Job("twin", "spconvert --to text in/ground.spm", "-o out/twin.txt", ""),
    Job("stream", "spconvert --to spm in/twin.txt", "-o out/stream.spm", ""),
    Job("points", "spconvert in/tile.laz --attributes all --to text", "-o out/points.txt", ""),
    Job("vtu", "spconvert in/cloud.spm", "-o out/cloud.vtu", "--to vtu"),
    Job("landxml", "spconvert in/ground.spm", "-o out/ground.xml", "--to landxml"),
    Job("glb", "spconvert in/ground.spm", "-o out/ground.glb", "--to glb"),
    Job("ugrid", "spconvert in/ground.spm", "-o out/ground.nc", "--to ugrid"),
]
