"""Figures as markdown."""

from contests import ALONE, DECODER, FROM_LAZ, OURS


def table(head, rows):
    """A markdown table; all columns but the first are aligned to the right."""
    lines = ["| " + " | ".join(head) + " |", "|---" + "|---:" * (len(head) - 1) + "|"]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def number(value, digits=None):
    """With the digits said, or two, and three below one."""
    if value is None:
        return ""
    return f"{value:.{(3 if value < 1 else 2) if digits is None else digits}f}"


def megabytes(peaks):
    """Peaks of all processes in MB; of several, their sum first."""
    each = [f"{peak / 1e6:.0f}" for peak in peaks]
    return each[0] if len(each) == 1 else f"{sum(peaks) / 1e6:.0f} ({' + '.join(each)})"


def spread(contestant, value):
    values = [value(run) for run in contestant.runs]
    return f"{number(min(values))}-{number(max(values))}"


def triangles(contest, contestant):
    count = contestant.said("triangles")
    if count is None:
        return ""
    return f"{count:,.0f}" + ("" if count == contest.triangles() else " **differs**")


def ratio(contest, contestant):
    ours = contest.get(OURS)
    value = contest.seconds(contestant)
    return number(value / contest.seconds(ours), 2) if ours and value is not None else ""


def kernel_row(contest, c):
    seconds = c.said("seconds")
    span = spread(c, lambda run: run.said["seconds"])
    per_point = number(seconds / contest.points * 1e6, 3)
    return [c.name, number(seconds), span, per_point, ratio(contest, c), megabytes(c.peaks), triangles(contest, c)]


def pipe_row(contest, c):
    alone = c.said("seconds") if len(c.commands) == 1 else None
    cells = [number(c.wall), spread(c, lambda run: run.wall), number(c.median(lambda run: run.cpu)), number(alone)]
    return [c.name, *cells, ratio(contest, c), megabytes(c.peaks), triangles(contest, c)]


KERNEL_HEAD = ["program", "seconds", "range", "us/point", "times ours", "peak MB", "triangles"]
PIPE_HEAD = ["program", "wall s", "range", "CPU s", "triangulation s", "times ours", "peak MB", "triangles"]


def contest(contest):
    """A table of one contest, with who is absent, and what follows from it."""
    head, make = (PIPE_HEAD, pipe_row) if contest.is_pipe else (KERNEL_HEAD, kernel_row)
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
    if ours and peers:
        best = peers[0]
        times = contest.seconds(best) / contest.seconds(ours)
        memory = 100 * sum(ours.peaks) / sum(best.peaks)
        yield f"{times:.2f} times as fast as {best.name}, the fastest peer, with {memory:.1f} % of its peak memory"
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


def machine(facts):
    """Where this was measured."""
    return table(["machine", ""], [[key, str(value)] for key, value in facts.items()])


def peers(peers):
    rows = [[p.name, p.version or f"not installed: {p.reason}", p.source, p.exact] for p in peers]
    return table(["peer", "version", "from", "exact"], rows)
