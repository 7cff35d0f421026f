"""The peers in 2D."""

import shutil

from installer import UNFUSED, Installer, Missing, Peer, apt_install, call, debian, debian_version

INTEGERS = "yes, of 32-bit integers; other coordinates are rounded to 26 bits"
DELAUNAY32 = "https://github.com/morishuz/delaunay32"

PEERS = [
    Peer("CGAL", "Debian", "yes", "cgal"),
    Peer("Triangle", "PyPI", "yes", "triangle"),
    Peer("Geogram", "PyPI", "yes", "geogram"),
    Peer("CDT", "PyPI", "adaptive", "cdt"),
    Peer("delaunator", "crates.io", "orientation only", "delaunator"),
    Peer("spade", "crates.io", "yes", "spade"),
    Peer("startin", "crates.io", "yes", "startin"),
    Peer("delaunay32", "GitHub", INTEGERS, "delaunay32"),
    Peer("delaunay32, 2 threads", "GitHub", INTEGERS, "delaunay32_2", threads=2),
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

    def delaunay32(self, threads=1):
        place = self.checkout("delaunay32", DELAUNAY32, "SPMESH_DELAUNAY32")
        version = (place / "CMakeLists.txt").read_text().split("project(delaunay32 VERSION ")[1].split()[0]
        flags = [f"-DTHREADS={threads}", f"-I{place / 'include'}", *sorted(place.glob("src/*.cpp")), "-lpthread"]
        return self.compile("delaunay32", *flags, name=f"delaunay32-{threads}"), version

    def delaunay32_2(self):
        return self.delaunay32(threads=2)

    def pdal(self):
        if not shutil.which("pdal"):
            apt_install("pdal")
        return shutil.which("pdal"), debian_version("pdal")

    def delabella(self):
        raise Missing("in no public registry (Debian, crates.io, PyPI, npm)")
