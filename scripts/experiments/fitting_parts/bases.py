"""Bases of quadratic splines over knots on a square grid with its border pulled apart (figure 8.8)."""

import re

import numpy as np

from work import ours

GRID = ("--degree", "1", "--pull-apart", "boundary")


def grid(work, cells):
    """Knots at integers, so that ties of the triangulation stay exact."""
    steps = np.arange(cells + 1)
    return work.table("knots.xy", [[x, y] for y in steps for x in steps])


def delaunay(work, knots):
    return made(work, knots)


def box_links(work, knots):
    """Links as box splines need them, but with separate B-splines of edges.

    The stream lists box splines, which are linearly dependent, and the remaining B-splines. A B-spline in a
    box spline has one half there and the other half in another function: the halves become one function
    again.
    """
    twin = work.folder / "boxes.txt"
    twin.write_text(ours("spconvert", "--quiet", "--to", "text", made(work, knots, "--box", "zp")).stdout)
    head, functions, tail = split(twin.read_text().splitlines())
    halves = {tuple(term[:2]) for _, terms in functions for term in terms if term[2] == "0.5"}
    kept = [(kind, terms) for kind, terms in functions if not halves & {tuple(term[:2]) for term in terms}]
    whole = [(["edge", *pair], [[*pair, "1"]]) for pair in halves]
    # Functions are sorted by kind, and edges are the first kind.
    edges = sorted([f for f in kept if f[0][0] == "edge"] + whole, key=lambda f: [int(word) for word in f[0][1:]])
    others = [f for f in kept if f[0][0] != "edge"]
    lines = [line for kind, terms in edges + others for line in ["function " + " ".join(kind), *map(term_line, terms)]]
    # The last line counts functions where other streams count vertices.
    tail = [re.sub(r"vertices \d+", f"vertices {len(edges + others)}", line) for line in tail]
    twin.write_text("\n".join([*head, *lines, *tail]) + "\n")
    return twin


def split(lines):
    """The lines before the functions of a text twin, the functions as pairs of a kind and terms, and the
    lines after them."""
    places = [number for number, line in enumerate(lines) if line.startswith(("function ", "term "))]
    functions = []
    for line in lines[places[0] : places[-1] + 1]:
        word, *rest = line.split()
        if word == "function":
            functions.append((rest, []))
        else:
            functions[-1][1].append(rest)
    return lines[: places[0]], functions, lines[places[-1] + 1 :]


def term_line(term):
    return "term " + " ".join(term)


def flipped(count):
    """The configurations after `count` random flips of the start triangulation."""
    return lambda work, knots, seed: made(work, knots, "--flip", f"random:{count}:{seed}")


def aligned(work, knots):
    """The configurations after flips towards edges along y."""
    return made(work, knots, "--flip", "aligned:90")


def made(work, knots, *flags):
    configurations = work.folder / "configurations.spm"
    ours("configgen", "--quiet", *GRID, *flags, knots, "-o", configurations)
    return configurations
