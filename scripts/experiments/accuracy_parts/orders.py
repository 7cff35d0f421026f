"""Figure 3.3: time under five orders of insertion."""

from programs import progress, write_tsv
from svg import BLUE, GREEN, ORANGE, PURPLE, RED, Axis, Curve, Panel, axis_from_zero, document

ORDERS = {"hilbert": BLUE, "row-major": ORANGE, "gray": GREEN, "morton": PURPLE, "random": RED}
BITS = 23


def run(place, flags):
    count = 10_000 if flags.quick else 100_000
    rows = []
    for number in range(1, flags.runs + 1):
        place.make(count, BITS, number)
        # In turn, as a machine's pace drifts.
        for order in ORDERS:
            told = place.triangulate("--arithmetic", "float", "--order", order)
            rows.append((order, number, count, told["seconds_triangulate"]))
        progress(f"orders: set {number} of {flags.runs}")
    write_tsv(flags.out / "figure-3.3.tsv", ("order", "set", "points", "seconds"), rows)
    (flags.out / "figure-3.3.svg").write_text(draw(rows))


def draw(rows):
    numbers = sorted({number for _, number, _, _ in rows})
    across = Axis([(number, str(number)) for number in numbers], "set of random points")
    up = axis_from_zero(max(seconds for *_, seconds in rows))
    curves = [
        Curve(order, colour, [(number, seconds) for name, number, _, seconds in rows if name == order])
        for order, colour in ORDERS.items()
    ]
    panel = Panel(56, 420, 64, 304, f"Seconds for {rows[0][2]:,} points", across, up)
    return document(540, 360, "Running time of sets of random points under five orders of insertion", panel.draw(curves))
