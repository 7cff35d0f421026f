"""Figure 3.5: in-sphere tests with rounding errors during the construction."""

from itertools import product

from programs import measured, write_tsv
from svg import Axis, Curve, Panel, axis_of_counts, document

ORDERS = {
    "random": ["--order", "random", "--bit-levels", "off"],
    "Hilbert": ["--order", "hilbert", "--bit-levels", "off"],
    "Hilbert and bit levels": ["--order", "hilbert", "--bit-levels", "on"],
}
BITS = [10, 12, 13, 14, 15, 16, 17, 18, 20, 23]
SIZES, QUICK_SIZES = [1000, 3000, 10_000, 30_000, 100_000], [1000, 3000]
QUICK_BITS = [10, 16, 20, 23]
LEAST_PERCENT = 1e-4
NEARLY_ALL = 95
HEAD = ("order", "points", "bits", "run", "in_sphere_tests", "wrong_signs", "wrong_zeros", "rounded", "percent_rounded")


def run(place, flags):
    sizes, all_bits = (QUICK_SIZES, QUICK_BITS) if flags.quick else (SIZES, BITS)
    rows = measured(place, flags, "signs", product(sizes, all_bits), ORDERS, row)
    write_tsv(flags.out / "figure-3.5.tsv", HEAD, rows)
    (flags.out / "figure-3.5.svg").write_text(draw(rows))


def row(place, order, count, bits, number):
    told = place.triangulate("--arithmetic", "float", "--check-signs", *ORDERS[order])
    figures = [told[key] for key in ("in_sphere_tests", "wrong_signs", "wrong_zeros", "rounded")]
    tests, *_, rounded = figures
    return order, count, bits, number, *figures, float(f"{100 * rounded / max(tests, 1):.6g}")


def draw(rows):
    """A panel for each order, with a curve for each number of bits through the means, and a dot for each
    run."""
    across = axis_of_counts({row[1] for row in rows}, "points")
    up = Axis([(LEAST_PERCENT, "0"), *((10.0**power, f"{10.0**power:g}") for power in range(-3, 3))], is_log=True)
    parts = []
    for place, order in enumerate(ORDERS):
        left = 56 + 390 * place
        panel = Panel(left, left + 220, 64, 364, f"Rounded, %: {order}", across, up)
        parts += panel.draw(curves([row for row in rows if row[0] == order]))
    alt = "Percentage of in-sphere tests with round-off errors against the number of points, by coordinate bits, for three orders"
    return document(1180, 420, alt, parts)


def curves(rows):
    """The curves, fewest bits first. Curves that end near the top share a name; curves without rounding
    errors have none."""
    all_bits = sorted({row[2] for row in rows})
    is_named = True
    for place, bits in enumerate(all_bits):
        dots = [(row[1], row[-1]) for row in rows if row[2] == bits]
        means = [(count, mean([y for x, y in dots if x == count])) for count in sorted({x for x, _ in dots})]
        is_last_name = means[-1][1] > NEARLY_ALL
        name = f"{bits} bits or more" if is_last_name else f"{bits} bits"
        has_name = is_named and any(y > 0 for _, y in dots)
        is_named = is_named and not is_last_name
        yield Curve(name if has_name else "", shade(place, len(all_bits)), means, dots=tuple(dots))


def mean(values):
    return sum(values) / len(values)


def shade(place, count):
    """A colour from blue for few bits to red for many."""
    share = place / max(count - 1, 1)
    return "#" + "".join(f"{round(a + share * (b - a)):02x}" for a, b in ((0x35, 0xD0), (0x83, 0x54), (0xD6, 0x6A)))
