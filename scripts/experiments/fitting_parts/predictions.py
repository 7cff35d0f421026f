"""Values at sites predicted from points by our program and by peers, with time and memory."""

import importlib.util
import pathlib
import sys
from dataclasses import dataclass

import inputs
import measure
import numpy as np
from work import Failed

HERE = pathlib.Path(__file__).resolve().parent
LIMIT_S = 300.0


@dataclass
class Prediction:
    """The values at sites with time and memory; without values, a reason."""

    values: object = None
    seconds: float = 0.0
    peak_bytes: int = 0
    # Coefficients of a spline.
    unknowns: object = ""
    reason: str = ""


@dataclass
class Ours:
    """splinefit with flags; `knots`, if given, makes a file of knots from points, and `step` is in units of
    point distances."""

    name: str
    flags: tuple = ()
    knots: object = None
    step: float = 0.0

    def predict(self, work, points, sites, _):
        """Runs two processes, one that fits and one that evaluates."""
        try:
            flags = [*self.flags, *(("--knots", self.knots(work, points)) if self.knots else ())]
            if self.step:
                distance = np.sqrt(np.prod(np.ptp(points[:, :2], axis=0)) / len(points))
                flags += ["--step", f"{self.step * distance:.6g}"]
            table, at = work.table("points.xyz", points), work.table("at.xy", sites)
            fit = run([inputs.program("splinefit"), "fit", "--quiet", "--stats=json", *flags, table, "-o", work.spline])
            out = work.folder / "values.txt"
            evaluation = run([inputs.program("splinefit"), "eval", "--quiet", work.spline, "--at", at, "-o", out])
        except Failed as failure:
            return Prediction(reason=str(failure))
        peak = max(fit.peaks + evaluation.peaks)
        return Prediction(np.loadtxt(out)[:, 2], fit.wall + evaluation.wall, peak, fit.said["functions"])


@dataclass
class Scipy:
    """A method of peer_program.py, which may take a number of unknowns."""

    name: str
    method: str
    has_unknowns: bool = False
    package: str = "scipy"

    def predict(self, work, points, sites, unknowns):
        if not is_installed(self.package):
            return Prediction(reason=f"{self.package} is not installed")
        files = [work.folder / f"{name}.npy" for name in ("points", "sites", "values")]
        np.save(files[0], points)
        np.save(files[1], sites)
        words = [unknowns] if self.has_unknowns else []
        try:
            taken = run([sys.executable, HERE / "peer_program.py", self.method, *files, *words])
        except Failed as failure:
            return Prediction(reason=str(failure))
        return Prediction(np.load(files[2]), taken.wall, max(taken.peaks), *words)


PEERS = [
    Scipy("linear, Delaunay triangulation (scipy)", "linear"),
    Scipy("Clough-Tocher (scipy)", "clough-tocher"),
    Scipy("thin plates, 50 neighbours (scipy)", "thin-plates"),
    Scipy("bicubic, least squares (scipy)", "bicubic", has_unknowns=True),
]

KRIGING = [
    Scipy(f"ordinary kriging, {model} (pykrige)", f"kriging-{model}", package="pykrige")
    for model in ("linear", "power", "spherical", "exponential")
]


def is_installed(package):
    return importlib.util.find_spec(package) is not None


def has_scipy():
    return is_installed("scipy")


def run(command):
    result = measure.run([command], LIMIT_S)
    if result.failure:
        # The program's message, without file paths.
        raise Failed(result.failure.split(": ", 2)[-1].rsplit(".xyz: ", 1)[-1])
    return result


def compare(work, ways, points, sites, truth):
    """A row for each way: unknowns, root mean square error, median, 99th percentile and greatest error, sites
    without a value, seconds, and peak memory.

    Bicubic splines have as many unknowns as our first spline.
    """
    unknowns, rows = 0, []
    for way in ways:
        found = way.predict(work, points, sites, unknowns)
        if isinstance(way, Ours) and not unknowns:
            unknowns = found.unknowns or 0
        rows.append([way.name, *cells(found, truth)])
        print(f"  {rows[-1]}", file=sys.stderr, flush=True)
    return rows


HEAD = ("unknowns", "RMSE", "median", "99 % below", "greatest", "sites without value", "seconds", "peak MB")


def cells(found, truth):
    if found.values is None:
        return [f"none: {found.reason}"]
    errors = np.abs(found.values - truth)
    known = errors[~np.isnan(errors)]
    numbers = [np.sqrt(np.mean(known**2)), np.median(known), np.percentile(known, 99), known.max()]
    # Below the floor, the peak may not be the program's.
    megabytes = f"{max(found.peak_bytes, measure.floor_bytes()) / 1e6:.0f}"
    at_most = "" if found.peak_bytes > measure.floor_bytes() else "at most "
    unknown = len(errors) - len(known)
    return [found.unknowns, *(f"{number:.3g}" for number in numbers), unknown, f"{found.seconds:.2f}", at_most + megabytes]
