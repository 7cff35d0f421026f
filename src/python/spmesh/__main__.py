"""python -m spmesh FILE ...: what streams hold; exits with 3 or 6 if one is malformed or too new."""

import sys

import spmesh


def main(names: list[str]) -> int:
    if not names:
        print(__doc__, file=sys.stderr)
        return 2
    for name in names:
        try:
            with spmesh.open(sys.stdin.buffer if name == "-" else name) as reader:
                totals = next((block.totals for block in reader if isinstance(block, spmesh.End)), {})
        except spmesh.SpmeshError as error:
            print(f"spmesh: {name}: {error}", file=sys.stderr)
            return 6 if isinstance(error, spmesh.TooNewError) else 3
        except (OSError, ImportError) as error:
            print(f"spmesh: {name}: {error}", file=sys.stderr)
            return 1
        counts = ", ".join(f"{count} {total}" for total, count in totals.items() if count)
        attributes = ", ".join(attribute.name for attribute in reader.header.attributes)
        print(f"{name}: {reader.header.kind}: {counts or 'empty'}" + (f"; attributes {attributes}" if attributes else ""))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
