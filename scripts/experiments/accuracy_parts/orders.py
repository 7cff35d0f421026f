"""Figure 3.3: time under five orders of insertion."""

from programs import progress, write_tsv
from svg import BLUE, GREEN, ORANGE, PURPLE, RED, Axis, Curve, Panel, axis_from_zero, document

ORDERS = {"hilbert": BLUE, "row-major": ORANGE, "gray": GREEN, "morton": PURPLE, "random": RED}
BITS = 23
# The least time counts, because other programs can only add to it.
REPEATS = 3


def run(place, flags):
    count = 10_000 if flags.quick else 100_000
    rows = []
    for number in range(1, flags.runs + 1):
        place.make(count, BITS, number)
        # The orders take turns, because the machine's speed drifts.
        times = [{order: seconds(place, order) for order in ORDERS} for _ in range(REPEATS)]
        rows += [(order, number, count, min(of_all[order] for of_all in times)) for order in ORDERS]
        progress(f"orders: set {number} of {flags.runs}")
    write_tsv(flags.out / "figure-3.3.tsv", ("order", "set", "points", "seconds"), rows)
    (flags.out / "figure-3.3.svg").write_text(draw(rows))


def seconds(place, order):
    return place.triangulate("--arithmetic", "float", "--order", order)["seconds_triangulate"]


def draw(rows):
    """All orders, and beside them the orders along curves, whose times are close to each other."""
    title = f"Seconds for {rows[0][2]:,} points"
    parts = [
        *panel(56, title, rows, list(ORDERS)),
        *panel(496, f"{title}: curves", rows, [order for order in ORDERS if order != "random"]),
    ]
    return document(900, 360, "Running time of sets of random points under five orders of insertion", parts)


def panel(left, title, rows, orders):
    rows = [row for row in rows if row[0] in orders]
    numbers = sorted({number for _, number, _, _ in rows})
    across = Axis([(number, str(number)) for number in numbers], "set of random points")
    up = axis_from_zero(max(seconds for *_, seconds in rows))
    curves = [
        Curve(order, ORDERS[order], [(number, seconds) for name, number, _, seconds in rows if name == order])
        for order in orders
    ]
    return Panel(left, left + 300, 64, 304, title, across, up).draw(curves)
