#!/usr/bin/env python3
"""Runs the Python reader on every vector of formats/vectors, in one process.

    python3 check_vectors.py

A vector in pass must give its text twin (.txt), one in fail must be refused with the words and the exit code of
its .err file. So must the manifests of meshes in parts in joined: a twin is then that of the joined mesh.
Exit 0, or 1 with a line for each vector that came out otherwise.
"""

import glob
import io
import os
import sys

import spmesh_reader

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "formats", "vectors")


def load(path):
    with open(path, encoding="utf-8", newline="") as file:
        return file.read()


def read(data):
    """The text twin, or None and the lines of the .err file with the whole message."""
    lines = []
    return result_of(spmesh_reader.Stream(io.BytesIO(data), spmesh_reader.Text(lines.append)), lines)


def join(path):
    """As `read`, of a mesh in parts."""
    lines = []
    return result_of(spmesh_reader.Join(path, lines.append), lines)


def result_of(stream, lines):
    try:
        stream.read()
    except spmesh_reader.REFUSED as error:
        return None, ("%s: %s" % (stream.where, error), "exit code %d" % error.exit_code)
    return "".join(lines), None


def main():
    wrong = 0
    paths = sorted(glob.glob(os.path.join(FOLDER, "*", "*.hex")) + glob.glob(os.path.join(FOLDER, "joined", "*.json")))
    for path in paths:
        stem, name = os.path.splitext(path)[0], os.path.relpath(path, FOLDER)
        if path.endswith(".json"):
            text, error = join(path)
        else:
            text, error = read(bytes.fromhex("".join(line.split("#")[0] for line in load(path).splitlines())))
        if os.path.exists(stem + ".txt"):
            holds = text == load(stem + ".txt")
        else:
            words, code = load(stem + ".err").splitlines()
            holds = error is not None and words in error[0] and code == error[1]
        if not holds:
            wrong += 1
            print("check_vectors: %s: %s" % (name, ": ".join(error or ()) or "another text than expected"), file=sys.stderr)
    print("%d vectors, %d wrong" % (len(paths), wrong))
    return 1 if wrong or not paths else 0


if __name__ == "__main__":
    sys.exit(main())
