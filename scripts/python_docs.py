"""Writes docs/python.md, the reference of the Python package, from its docstrings: scripts/python_docs.py > docs/python.md

Needs the package on its path (PYTHONPATH=src/python is enough, without the compiled module).
"""

import inspect
import textwrap

import spmesh

PARTS = {
    "Triangulations and interpolation": "Delaunay LinearNDInterpolator NaturalNeighborInterpolator",
    "Terrain, splines, molecules": "tin Tin Raster fit Fit molecule Molecule",
    "Programs": "programs.run programs.Pipe programs.find programs.argument ProgramError ProgramNotFoundError",
    "Streams": "read Stream open write_points write_triangles write_tetrahedra Writer Header Attribute Tree attributes_of "
    "MalformedError TooNewError UpstreamError SpmeshError",
}


def text_of(thing):
    return textwrap.indent(inspect.getdoc(thing) or "", "    ")


def shown(text, indent):
    """A call as code, on several lines if it is long."""
    return textwrap.fill(text, 116, initial_indent=indent, subsequent_indent=indent + 4 * " ", break_long_words=False)


def signature(name, thing):
    try:
        parameters = [
            str(parameter.replace(annotation=inspect.Parameter.empty)).replace(" = ", "=")
            for key, parameter in inspect.signature(thing).parameters.items()
            if key != "self"
        ]
    except (TypeError, ValueError):
        return name
    stars = [place for place, text in enumerate(parameters) if not text.startswith("*")]
    kinds = [parameter.kind for key, parameter in inspect.signature(thing).parameters.items() if key != "self"]
    keyword = inspect.Parameter.KEYWORD_ONLY
    if keyword in kinds and inspect.Parameter.VAR_POSITIONAL not in kinds and stars:
        parameters.insert(kinds.index(keyword), "*")
    return f"{name}({', '.join(parameters)})"


def members(kind):
    """Public methods and properties, those of its base classes in this package included."""
    for name, member in inspect.getmembers(kind):
        home = next((base for base in kind.__mro__ if name in vars(base)), None)
        is_named = not name.startswith("_") or name == "__call__"
        if is_named and home is not None and home.__module__.startswith("spmesh") and inspect.getdoc(member):
            if callable(member) or isinstance(member, property) or hasattr(member, "func"):
                yield name, member


def main():
    print("# Python reference\n")
    print("Made of the docstrings by `scripts/python_docs.py`. [The package's page](../src/python/README.md) says how to begin.")
    for part, names in PARTS.items():
        print(f"\n## {part}")
        for name in names.split():
            thing = spmesh
            for step in name.split("."):
                thing = getattr(thing, step)
            print(f"\n### {name}\n\n{shown(signature('spmesh.' + name, thing), 4 * ' ')}\n\n{text_of(thing)}")
            if inspect.isclass(thing) and not issubclass(thing, Exception):
                for member, value in members(thing):
                    call = signature("." + member, value) if callable(value) else "." + member
                    print(f"\n{shown(call, 4 * ' ')}\n\n{textwrap.indent(text_of(value), '    ')}")


if __name__ == "__main__":
    main()
