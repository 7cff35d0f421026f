"""Table 3.1: wrong tetrahedra by the number of bits."""

import overflow
from programs import measured, write_tsv

# The thesis has one column for all numbers of bits up to 16.
BITS = [10, 12, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23]
QUICK_BITS = [10, 16, 20, 23]
ARITHMETICS = ("float", "exact")
AUDITS = ("exact", "float")
FAULTS = ("inside", "on", "inverted", "flat")
HEAD = (
    *("arithmetic", "bits", "run", "points", "missing_points", "tetrahedra"),
    *(f"{audit}_{fault}" for audit in AUDITS for fault in FAULTS),
    "overflowing_inside_or_on",
)
# The faults that a line of the printed table sums up. A neighbour's vertex on a sphere is not a fault.
LINES = [
    (audit, name, tuple(HEAD.index(f"{audit}_{fault}") for fault in faults))
    for audit in AUDITS
    for name, faults in (("Delaunay", ("inside",)), ("orientation", ("inverted", "flat")))
]
OVERFLOWING = ("64 bits", "Delaunay", (len(HEAD) - 1,))


def run(place, flags):
    count = 10_000 if flags.quick else 100_000
    all_bits = QUICK_BITS if flags.quick else BITS
    rows = measured(place, flags, "table", [(count, bits) for bits in all_bits], ARITHMETICS, row)
    write_tsv(flags.out / "table-3.1.tsv", HEAD, rows)
    (flags.out / "table-3.1.md").write_text(markdown(rows))
    print(markdown(rows))


def row(place, arithmetic, count, bits, number):
    told = place.triangulate("--arithmetic", arithmetic)
    counted = place.audit()
    faults = [counted[audit][fault] for audit in AUDITS for fault in FAULTS]
    # One mesh is enough: this audit is slow, and it tests overflow, not tess3.
    is_first_exact = number == 1 and arithmetic == "exact"
    overflowing = overflow.count_not_delaunay(*place.tetrahedra()) if is_first_exact else ""
    return arithmetic, bits, number, count, told.get("missing", 0), told["tetrahedra"], *faults, overflowing


def markdown(rows):
    """Percentages of the tetrahedra of all runs, laid out as in the thesis."""
    all_bits = sorted({row[1] for row in rows})
    head = "| arithmetic | audit | error, % |" + "".join(f" {bits} |" for bits in all_bits)
    lines = [head, "|---" * 3 + "|---:" * len(all_bits) + "|"]
    for arithmetic in ARITHMETICS:
        for audit, name, columns in LINES + [OVERFLOWING] * (arithmetic == "exact"):
            of_bits = ([row for row in rows if row[:2] == (arithmetic, bits)] for bits in all_bits)
            shares = "".join(f" {share(chosen, columns):.3g} |" for chosen in of_bits)
            lines.append(f"| {arithmetic} | {audit} | {name} |{shares}")
    return "\n".join(lines) + "\n"


def share(rows, columns):
    """Percentage of faults in these columns, among the tetrahedra of the rows that have values there."""
    rows = [row for row in rows if row[columns[0]] != ""]
    return 100 * sum(row[column] for row in rows for column in columns) / max(sum(row[5] for row in rows), 1)
