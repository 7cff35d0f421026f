"""What the ratios of a contest say, in words and as JSON."""

import ratios
from contests import ALONE, DECODER, FROM_LAZ, HXT_TWICE, IN_PARTS, OURS, OURS_TWICE, TESS3, cpu, memory, wall
from peers3 import CGAL


def lines(contest):
    """All conclusions of a contest, as sentences."""
    yield from against_peers(contest)
    yield from of_threads(contest)
    yield from from_laz(contest)
    parts, ours = contest.get(IN_PARTS), contest.get(OURS)
    if parts:
        yield from parts3(parts)
    if contest.dims == 4 and ours:
        yield from parts4(ours)


def against_peers(contest):
    """Time and memory of the fastest peer, and of CGAL, as ratios to ours."""
    ours, peers = contest.get(OURS), contest.peers()
    if not ours or not peers:
        return
    # Elevation models have two peers, and both are named.
    chosen = peers[:1] if contest.dims else peers
    if contest.dims >= 3:
        chosen += [peer for peer in peers[1:] if peer.name == CGAL]
    for peer in chosen:
        which = f"{peer.name}, the fastest peer" if peer is peers[0] and contest.dims else peer.name
        yield contest.ratio(peer, ours).told(f"times as fast as {which}")
        yield from of(cpu, contest, ours, peer, f"times the CPU time of {peer.name}, from start to end")
        yield from of(memory, contest, ours, peer, f"times the peak memory of {peer.name}")
    if contest.dims >= 3 and ours.median(memory):
        yield f"{sum(ours.peaks) / contest.points:.0f} bytes per point"


def of(value, contest, over, under, words):
    """A ratio of values that are not known of each run."""
    ratio = contest.ratio(over, under, value)
    if ratio:
        yield ratio.told(words)


def of_threads(contest):
    """Our kernel of space, our reduction and our sweeps on two threads."""
    for one, two in ((OURS, OURS_TWICE), (ALONE.format(1), ALONE.format(2)), (TESS3.format(1), TESS3.format(2))):
        one, two = contest.get(one), contest.get(two)
        if one and two:
            yield contest.ratio(one, two).told(f"times as fast on two threads as on one: {two.name}")
            yield from of(cpu, contest, two, one, "times the CPU time of one, on two threads")
            yield from of(memory, contest, two, one, "times the peak memory of one, on two threads")
    ours, hxt = contest.get(OURS_TWICE), contest.get(HXT_TWICE)
    if ours and hxt:
        yield contest.ratio(hxt, ours).told("times as fast as HXT, on two threads each")
        yield from of(memory, contest, ours, hxt, "times the peak memory of HXT, on two threads each")


def laz_ratios(contest):
    """The pipe from LAZ to the sum of its parts, and to decoding alone; None if one of them did not run."""
    found = [contest.get(name) for name in (FROM_LAZ, DECODER, ALONE.format(2))]
    if not all(found):
        return None
    laz, decoder, alone = (contestant.by_round(wall) for contestant in found)
    both = laz.keys() & decoder.keys() & alone.keys()
    parts = {number: decoder[number] + alone[number] for number in both}
    rest = {number: laz[number] - alone[number] for number in both}
    return ratios.ratio(laz, parts), ratios.ratio(rest, decoder)


def from_laz(contest):
    found = laz_ratios(contest)
    if not all(found or [None]):
        return
    laz, decoder, two = (contest.get(name).wall for name in (FROM_LAZ, DECODER, ALONE.format(2)))
    parts = f"one parallel decoding ({decoder:.2f} s) and the triangulation on two threads ({two:.2f} s)"
    yield f"LAZ to mesh ({laz:.2f} s): {found[0].told('times as long as ' + parts)}"
    yield f"LAZ to mesh without the triangulation: {found[1].told('times the decoding')}"


def parts3(ours):
    """The columns of thesis table 3.3 for our kernel."""
    words = ("order", "locate", "predicates", "update")
    times = [f"{word} {ours.said(f'{word}_seconds'):.3f} s" for word in words]
    yield f"ours, table 3.3: {', '.join(times)}, of {ours.said('seconds'):.3f} s with the clock"
    created, tests = ours.said("created"), ours.said("in_sphere_tests")
    yield f"ours, table 3.3: {created:,.0f} tetrahedra created, {tests:,.0f} in-sphere tests"


def parts4(ours):
    """The parts of our time, and the parts that peers leave out."""
    order, insertion, merge = (ours.said(f"{part}_seconds") for part in ("order", "insertion", "merge"))
    created, tests = ours.said("created"), ours.said("in_sphere_tests")
    yield f"ours: order {order:.3f} s, insertion {insertion:.3f} s, merge {merge:.3f} s"
    yield f"ours: {created:,.0f} simplices created, {tests:,.0f} in-sphere tests"
    yield "CGAL, and Qhull with Qt, triangulate only: making cells, our merge, is no part of their time"


def note(rounds):
    """What parentheses mean, for contestants with these numbers of rounds."""
    counts = sorted({count for count in rounds if count > 1}, reverse=True)
    levels = []
    for count in counts:
        at = ratios.rank(count)
        levels.append(f"ranks {at} and {count + 1 - at} of {count} rounds, {ratios.percent(ratios.level(count, at))}")
    text = "Ratios are medians of the ratios of each round"
    text += f", with an interval of the median: {'; '.join(levels)}" if levels else ""
    return text + (". A program that is run once has no interval" if 1 in rounds else "") + ".\n"


def as_json(contest):
    """The contest with all of its ratios, round by round."""
    pairs = [(c.name, OURS) for c in contest.contestants if c.name != OURS]
    pairs += [(CGAL, c.name) for c in contest.contestants if contest.dims >= 3 and c.name not in (OURS, CGAL)]
    pairs += [(OURS, OURS_TWICE), (HXT_TWICE, OURS_TWICE)]
    pairs += [(name.format(1), name.format(2)) for name in (ALONE, TESS3)]
    found = [entry for over, under in pairs for entry in entries(contest, over, under)]
    of_laz = ("LAZ to decoding and triangulation", "the rest of LAZ to decoding")
    for name, ratio in zip(of_laz, laz_ratios(contest) or ()):
        found.append({"over": name, "of": "seconds", **ratio.as_json()})
    return {**contest.as_json(), "ratios": found}


def entries(contest, over, under):
    """Ratios of time, CPU time and memory of two contestants, given by name, if both ran."""
    upper, lower = contest.get(over), contest.get(under)
    for name, value in (("seconds", contest.seconds_of), ("cpu_s", cpu), ("peak_bytes", memory)):
        ratio = upper and lower and contest.ratio(upper, lower, value)
        if ratio:
            yield {"over": over, "under": under, "of": name, **ratio.as_json()}
