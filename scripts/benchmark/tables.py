"""Results as Markdown tables."""

import conclusions
import ratios
from contests import OURS
from peers3 import CGAL, PEERS as PEERS3

PEERS_OF_STRUCTURES = [peer.name for peer in PEERS3 if peer.threads == 1]


def table(head, rows):
    """A Markdown table; all columns but the first are right-aligned."""
    lines = ["| " + " | ".join(head) + " |", "|---" + "|---:" * (len(head) - 1) + "|"]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def number(value, digits=None):
    """A number with the given digits; by default with two, or three if it is below one."""
    if value is None:
        return ""
    return f"{value:.{(3 if value < 1 else 2) if digits is None else digits}f}"


def megabytes(peaks):
    """Peaks of all processes in MB; their sum first if there are several."""
    each = [f"{peak / 1e6:.0f}" for peak in peaks]
    return each[0] if len(each) == 1 else f"{sum(peaks) / 1e6:.0f} ({' + '.join(each)})"


def spread(contestant, value):
    values = [value(run) for run in contestant.runs]
    return f"{number(min(values))}-{number(max(values))}"


def elements(contest, contestant):
    count = contestant.said(contest.element)
    if count is None:
        return ""
    return f"{count:,.0f}" + ("" if count == contest.elements() else " **differs**")


def times_ours(contest, contestant):
    """The ratio of a contestant's time to ours."""
    ours = contest.get(OURS)
    return said(contest.ratio(contestant, ours)) if ours and contestant is not ours else ""


def said(ratio):
    return "" if ratio is None else str(ratio)


def kernel_row(contest, c):
    seconds = c.said("seconds")
    span = spread(c, lambda run: run.said["seconds"])
    per_point = number(seconds / contest.points * 1e6, 3)
    return [c.name, number(seconds), span, per_point, times_ours(contest, c), megabytes(c.peaks), elements(contest, c)]


def kernel3_row(contest, c):
    seconds = c.said("seconds")
    span = spread(c, lambda run: run.said["seconds"])
    per_point = number(seconds / contest.points * 1e6, 3)
    cgal = contest.get(CGAL)
    speed = said(contest.ratio(cgal, c)) if cgal and cgal is not c else ""
    bytes_per_point = f"{c.peaks[0] / contest.points:.0f}" if c.median(lambda run: run.memory) else ""
    cells = [per_point, times_ours(contest, c), speed, megabytes(c.peaks), bytes_per_point, elements(contest, c)]
    return [c.name, number(seconds), span, *cells]


def kernel4_row(contest, c):
    """A 3D row with two more counts. Programs that only triangulate have no cells; those that merge have no
    simplices."""
    simplices, infinite = c.said("simplices"), c.said("infinite_cells")
    counts = ["" if count is None else f"{count:,.0f}" for count in (infinite, simplices)]
    return [*kernel3_row(contest, c), *counts]


def pipe_row(contest, c):
    alone = c.said("seconds") if len(c.commands) == 1 else None
    cells = [number(c.wall), spread(c, lambda run: run.wall), number(c.median(lambda run: run.cpu)), number(alone)]
    return [c.name, *cells, times_ours(contest, c), megabytes(c.peaks), elements(contest, c)]


KERNEL_HEAD = ["program", "seconds", "range", "us/point", "times ours", "peak MB", "triangles"]
KERNEL3_HEAD = [*KERNEL_HEAD[:5], "CGAL's times its", "peak MB", "bytes/point", "tetrahedra"]
KERNEL4_HEAD = [*KERNEL3_HEAD[:-1], "cells", "infinite", "simplices"]
PIPE_HEAD = ["program", "wall s", "range", "CPU s", "triangulation s", "times ours", "peak MB", "triangles"]


def contest(contest):
    """The table of one contest, the absent programs, and conclusions."""
    kernels = {3: (KERNEL3_HEAD, kernel3_row), 4: (KERNEL4_HEAD, kernel4_row)}
    head, make = kernels.get(contest.dims, (KERNEL_HEAD, kernel_row))
    if contest.is_pipe:
        head, make = PIPE_HEAD, pipe_row
    rows = []
    absent = dict(contest.absent)
    for contestant in contest.contestants:
        if contestant.runs:
            rows.append(make(contest, contestant))
        else:
            absent[contestant.name] = contestant.failure
    rows += [[name, reason, *[""] * (len(head) - 2)] for name, reason in absent.items()]
    title = f"### {contest.name}\n\n"
    return title + table(head, rows) + notes(contest, conclusions.lines(contest))


def notes(contest, lines):
    """Conclusions, and what their intervals are."""
    note = conclusions.note([len(c.runs) for c in contest.contestants])
    return "".join(f"\n* {line}" for line in lines) + f"\n\n{note}"


def machine(facts):
    """The machine of the measurements."""
    return table(["machine", ""], [[key, str(value)] for key, value in facts.items()])


def peers(peers):
    rows = [[p.name, p.version or f"not installed: {p.reason}", p.source, p.exact] for p in peers]
    return table(["peer", "version", "from", "exact"], rows)


def structures(contests, unread):
    """One row per structure, and one for all: seconds of all programs on one thread."""
    names = [OURS, *PEERS_OF_STRUCTURES]
    rows, sums = [], dict.fromkeys(names, 0.0)
    for contest in contests:
        times = {name: c.said("seconds") for name in names if (c := contest.get(name))}
        for name, time in times.items():
            sums[name] += time
        count = contest.elements()
        start = [contest.name, f"{contest.points:,}", f"{count:,.0f}" if count else ""]
        rows.append([*start, *[number(times.get(name)) for name in names]])
    points = sum(contest.points for contest in contests)
    rows.append(["all", f"{points:,}", "", *[number(sums[name] or None) for name in names]])
    speeds = ["" if name == CGAL else said(ratio_of_sums(contests, CGAL, name)) for name in names]
    rows.append(["CGAL's times its", "", "", *speeds])
    left_out = "".join(f"\n* {name}: not read: {reason}" for name, reason in unread.items())
    head = ["structure", "atoms", "tetrahedra", *[f"{name}, s" for name in names]]
    note = conclusions.note([len(c.runs) for contest in contests for c in contest.contestants])
    return "### structures\n\n" + table(head, rows) + left_out + f"\n\n{note}"


def ratio_of_sums(contests, over, under):
    """The ratio of times of two programs for all structures that both read, round by round."""
    both = [(upper, lower) for each in contests if (upper := each.get(over)) and (lower := each.get(under))]
    sums = [sum_by_round([c.by_round(lambda run: run.said["seconds"]) for c in side]) for side in zip(*both)]
    return ratios.ratio(*sums) if both else None


def sums_as_json(contests):
    """The ratios of these sums, round by round."""
    pairs = {name: ratio_of_sums(contests, CGAL, name) for name in [OURS, *PEERS_OF_STRUCTURES] if name != CGAL}
    found = [{"over": CGAL, "under": name, **ratio.as_json()} for name, ratio in pairs.items() if ratio]
    return {"name": "sums over structures", "ratios": found}


def sum_by_round(each):
    """Sums of values of the rounds that all have."""
    rounds = set.intersection(*(set(values) for values in each))
    return {number: sum(values[number] for values in each) for number in rounds}


def sweep(contest):
    """All structures in one run."""
    rows = []
    for c in contest.contestants:
        span = spread(c, lambda run: run.wall) if c.runs else ""
        cells = [number(c.median(lambda run: run.cpu)), megabytes(c.peaks)] if c.runs else ["", ""]
        rows.append([c.name, number(c.wall) if c.runs else c.failure, span, *cells])
    head = ["program", "wall s", "range", "CPU s", "peak MB"]
    title = f"### sweep over {contest.points} files\n\n"
    return title + table(head, rows) + notes(contest, conclusions.of_threads(contest))
