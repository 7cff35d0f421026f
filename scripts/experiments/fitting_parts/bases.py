"""Bases of quadratic splines over knots on a square grid whose border is pulled apart (thesis, figure 8.8)."""

import re

import numpy as np

from work import ours

GRID = ("--degree", "1", "--pull-apart", "boundary")


def grid(work, cells):
    """Knots at whole numbers, so that ties of the triangulation are ties."""
    steps = np.arange(cells + 1)
    return work.table("knots.xy", [[x, y] for y in steps for x in steps])


def delaunay(work, knots):
    return made(work, knots)


def box_links(work, knots):
    """Links as box splines need them, with the B-splines of edges as they are.

    The stream lists box splines, which depend on each other, and what B-splines are left. Each B-spline in a box spline has its
    parts there and in another function: these become one function again.
    """
    twin = work.folder / "boxes.txt"
    twin.write_text(ours("spconvert", "--quiet", "--to", "text", made(work, knots, "--box", "zp")).stdout)
    head, functions, tail = split(twin.read_text().splitlines())
    halves = {tuple(term[:2]) for _, terms in functions for term in terms if term[2] == "0.5"}
    kept = [(kind, terms) for kind, terms in functions if not halves & {tuple(term[:2]) for term in terms}]
    whole = [(["edge", *pair], [[*pair, "1"]]) for pair in halves]
    # Functions are in the order of their kinds, and edges are the first kind.
    edges = sorted([f for f in kept if f[0][0] == "edge"] + whole, key=lambda f: [int(word) for word in f[0][1:]])
    others = [f for f in kept if f[0][0] != "edge"]
    lines = [line for kind, terms in edges + others for line in ["function " + " ".join(kind), *map(term_line, terms)]]
    # The end counts functions, where other streams have vertices.
    tail = [re.sub(r"vertices \d+", f"vertices {len(edges + others)}", line) for line in tail]
    twin.write_text("\n".join([*head, *lines, *tail]) + "\n")
    return twin


def split(lines):
    """What comes before functions in a text twin, functions as pairs of a kind and terms, and what follows."""
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
    """After so many random flips of the start triangulation."""
    return lambda work, knots, seed: made(work, knots, "--flip", f"random:{count}:{seed}")


def aligned(work, knots):
    """After flips towards edges along y."""
    return made(work, knots, "--flip", "aligned:90")


def made(work, knots, *flags):
    configurations = work.folder / "configurations.spm"
    ours("configgen", "--quiet", *GRID, *flags, knots, "-o", configurations)
    return configurations
