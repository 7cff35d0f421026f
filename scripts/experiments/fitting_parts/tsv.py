"""Tables as files: TSV, and Markdown with the same cells."""

from work import progress


def write_tables(stem, head, rows):
    """Writes PATH.tsv and PATH.md; rows may be shorter than the head."""
    rows = [[str(cell) for cell in row] + [""] * (len(head) - len(row)) for row in rows]
    write(stem, ".tsv", "".join("\t".join(row) + "\n" for row in [head, *rows]))
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    written = write(stem, ".md", "".join("| " + " | ".join(line) + " |\n" for line in lines))
    print(f"{written}:\n{written.read_text()}")


def write(stem, ending, content):
    path = stem.with_name(stem.name + ending)
    path.write_text(content)
    progress(f"written: {path}")
    return path
