"""The table of what was found, and the messages that lead to each failure."""

import collections

from verdicts import KINDS

HEADS = ("tool", "cases", "runs", "faults", *(f"{kind}s" for kind in KINDS))


class Table:
    def __init__(self):
        self.rows = collections.defaultdict(collections.Counter)
        self.skipped = collections.Counter()

    def add(self, result, seed):
        """Counts a result and prints its complaints."""
        row = self.rows[result.tool]
        if result.skipped:
            self.skipped[result.fault, result.skipped] += 1
            return
        row.update(cases=1, runs=result.runs, faults=result.hits)
        for kind, text in result.complaints:
            row[f"{kind}s"] += 1
            print(
                f"{kind.upper()}  scripts/torture --seed {seed} --case {result.name}\n    {text}", flush=True
            )

    def has_failures(self):
        return any(row[f"{kind}s"] for row in self.rows.values() for kind in KINDS)

    def show(self):
        total = collections.Counter()
        for row in self.rows.values():
            total.update(row)
        lines = [HEADS]
        for tool, row in [*sorted(self.rows.items()), ("all", total)]:
            lines.append((tool, *(str(row[head]) for head in HEADS[1:])))
        widths = [max(map(len, column)) for column in zip(*lines)]
        for line in lines:
            print(
                "  ".join(
                    [
                        line[0].ljust(widths[0]),
                        *(cell.rjust(width) for cell, width in zip(line[1:], widths[1:])),
                    ]
                )
            )
        for (fault, reason), count in sorted(self.skipped.items()):
            print(f"skipped {count} x {fault}: {reason}")
