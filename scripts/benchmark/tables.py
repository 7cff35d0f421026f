"""Results as Markdown tables."""

from contests import ALONE, DECODER, FROM_LAZ, IN_PARTS, OURS, TESS3
from measure import floor_bytes
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


def ratio(contest, contestant):
    ours = contest.get(OURS)
    value = contest.seconds(contestant)
    return number(value / contest.seconds(ours), 2) if ours and value is not None else ""


def kernel_row(contest, c):
    seconds = c.said("seconds")
    span = spread(c, lambda run: run.said["seconds"])
    per_point = number(seconds / contest.points * 1e6, 3)
    return [c.name, number(seconds), span, per_point, ratio(contest, c), megabytes(c.peaks), elements(contest, c)]


def kernel3_row(contest, c):
    seconds = c.said("seconds")
    span = spread(c, lambda run: run.said["seconds"])
    per_point = number(seconds / contest.points * 1e6, 3)
    speed = number(contest.speed(c, contest.get(CGAL)), 2)
    # Near the floor, the peak may not be the program's.
    bytes_per_point = f"{c.peaks[0] / contest.points:.0f}" if c.peaks[0] > 1.1 * floor_bytes() else ""
    cells = [per_point, ratio(contest, c), speed, megabytes(c.peaks), bytes_per_point, elements(contest, c)]
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
    return [c.name, *cells, ratio(contest, c), megabytes(c.peaks), elements(contest, c)]


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
    return title + table(head, rows) + "".join(f"\n* {line}" for line in conclusions(contest)) + "\n"


def conclusions(contest):
    """Ratios, in words."""
    ours, peers = contest.get(OURS), contest.peers()
    # Elevation models have two peers, and both are named.
    for best in peers[: 1 if contest.dims else None] if ours else []:
        times = contest.seconds(best) / contest.seconds(ours)
        memory = 100 * sum(ours.peaks) / sum(best.peaks)
        which = f"{best.name}, the fastest peer," if contest.dims else best.name
        yield f"{times:.2f} times as fast as {which} with {memory:.1f} % of its peak memory"
    cgal = contest.get(CGAL)
    if contest.dims >= 3 and ours and cgal:
        times, memory = contest.speed(ours, cgal), sum(ours.peaks) / contest.points
        yield f"{times:.2f} times as fast as CGAL, with {memory:.0f} bytes per point"
    parts = contest.get(IN_PARTS)
    if parts:
        yield from conclusions3(parts)
    if contest.dims == 4 and ours:
        yield from conclusions4(ours)
    laz, decoder = contest.get(FROM_LAZ), contest.get(DECODER)
    one, two = (contest.get(ALONE.format(threads)) for threads in (1, 2))
    if one and two:
        yield f"two threads are {one.wall / two.wall:.2f} times as fast as one (finalized stream from a file)"
    if laz and decoder and two:
        times = (laz.wall - two.wall) / decoder.wall
        yield (
            f"from LAZ, {laz.wall:.2f} s: the triangulation alone on two threads ({two.wall:.2f} s) "
            f"and {times:.2f} times the decoding ({decoder.wall:.2f} s)"
        )


def conclusions3(ours):
    """The columns of thesis table 3.3 for our kernel."""
    words = ("order", "locate", "predicates", "update")
    times = [f"{word} {ours.said(f'{word}_seconds'):.3f} s" for word in words]
    yield f"ours, table 3.3: {', '.join(times)}, of {ours.said('seconds'):.3f} s with the clock"
    created, tests = ours.said("created"), ours.said("in_sphere_tests")
    yield f"ours, table 3.3: {created:,.0f} tetrahedra created, {tests:,.0f} in-sphere tests"


def conclusions4(ours):
    """The parts of our time, and the parts that peers leave out."""
    order, insertion, merge = (ours.said(f"{part}_seconds") for part in ("order", "insertion", "merge"))
    created, tests = ours.said("created"), ours.said("in_sphere_tests")
    yield f"ours: order {order:.3f} s, insertion {insertion:.3f} s, merge {merge:.3f} s"
    yield f"ours: {created:,.0f} simplices created, {tests:,.0f} in-sphere tests"
    yield "CGAL, and Qhull with Qt, triangulate only: making cells, our merge, is no part of their time"


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
    speeds = [number(sums[CGAL] / sums[name], 2) if sums[name] else "" for name in names]
    rows.append(["CGAL's times its", "", "", *speeds])
    left_out = "".join(f"\n* {name}: not read: {reason}" for name, reason in unread.items())
    head = ["structure", "atoms", "tetrahedra", *[f"{name}, s" for name in names]]
    return "### structures\n\n" + table(head, rows) + left_out + "\n"


def sweep(contest):
    """All structures in one run."""
    rows = []
    for c in contest.contestants:
        span = spread(c, lambda run: run.wall) if c.runs else ""
        cells = [number(c.median(lambda run: run.cpu)), megabytes(c.peaks)] if c.runs else ["", ""]
        rows.append([c.name, number(c.wall) if c.runs else c.failure, span, *cells])
    head = ["program", "wall s", "range", "CPU s", "peak MB"]
    text = f"### sweep over {contest.points} files\n\n" + table(head, rows)
    one, two = (contest.get(TESS3.format(threads)) for threads in (1, 2))
    if one and two:
        text += f"\n* two threads are {one.wall / two.wall:.2f} times as fast as one\n"
    return text + "\n"
