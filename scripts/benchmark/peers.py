"""The peers in 2D."""

import shutil

from installer import UNFUSED, Installer, Missing, Peer, apt_install, call, debian, debian_version

PEERS = [
    Peer("CGAL", "Debian", "yes", "cgal"),
    Peer("Triangle", "PyPI", "yes", "triangle"),
    Peer("Geogram", "PyPI", "yes", "geogram"),
    Peer("CDT", "PyPI", "adaptive", "cdt"),
    Peer("delaunator", "crates.io", "orientation only", "delaunator"),
    Peer("spade", "crates.io", "yes", "spade"),
    Peer("startin", "crates.io", "yes", "startin"),
    Peer("PDAL", "Debian", "no", "pdal", whole_only=True),
    Peer("Delabella", "none", "adaptive", "delabella"),
]


class Peers2(Installer):
    """Each method builds a program and returns it with its version."""

    dims = 2

    def cgal(self):
        version = debian("CGAL", "libcgal-dev", "libgmp-dev", "libmpfr-dev")
        return self.compile("cgal", "-frounding-math", "-lmpfr", "-lgmp"), version

    def triangle(self):
        place, version = self.package("triangle", "--no-binary", "triangle", "--no-build-isolation")
        sources = place / f"triangle-{version}" / "c"
        defines = ["TRILIBRARY", "REDUCED", "CDT_ONLY", "NO_TIMER", "ANSI_DECLARATORS", "REAL=double", "VOID=void"]
        part = self.folder / "triangle.o"
        flags = ["-O3", "-march=native", UNFUSED, "-w", *(f"-D{define}" for define in defines)]
        call("gcc", *flags, "-c", sources / "triangle.c", "-o", part)
        return self.compile("triangle", f"-I{sources}", part), f"1.6 (PyPI triangle {version})"

    def cdt(self):
        place, version = self.package("pythoncdt", "--no-binary", "pythoncdt", "--no-build-isolation")
        headers = place / f"pythoncdt-{version}" / "CDT" / "CDT"
        number = (headers / "CMakeLists.txt").read_text().split("VERSION", 2)[2].split()[0]
        return self.compile("cdt", UNFUSED, f"-I{headers / 'include'}"), f"{number} (PyPI pythoncdt {version})"

    def geogram(self):
        flags, version = self.geogram_flags()
        return self.compile("geogram", *flags), version

    def pdal(self):
        if not shutil.which("pdal"):
            apt_install("pdal")
        return shutil.which("pdal"), debian_version("pdal")

    def delabella(self):
        raise Missing("in no public registry (Debian, crates.io, PyPI, npm)")
