"""The peers in 3D."""

from installer import UNFUSED, Installer, Peer, call, debian

HXT = "HXT"
CGAL = "CGAL"
PEERS = [
    Peer(CGAL, "Debian", "yes", "cgal"),
    Peer(HXT, "Debian", "yes", "hxt"),
    Peer("Geogram BDEL", "PyPI", "yes", "geogram"),
    Peer("TetGen", "Debian", "yes", "tetgen"),
    Peer("Qhull", "Debian", "no", "qhull"),
    Peer(f"{CGAL}, 2 threads", "Debian", "yes", "cgal_parallel", threads=2),
    Peer(f"{HXT}, 2 threads", "Debian", "yes", "hxt", threads=2),
    Peer("Geogram PDEL, 2 threads", "PyPI", "yes", "geogram", threads=2),
]
# The parts of HXT that its Delaunay triangulation needs.
HXT_SOURCES = {
    "core": "hxt_bbox hxt_mesh hxt_message hxt_sort",
    "tetMesh": "hxt_tetDelaunay hxt_tetFlag hxt_tetNodalSize hxt_tetRepair hxt_tetSync hxt_tetUtils hxt_vertices",
    "predicates": "predicates",
}


class Peers3(Installer):
    """Each method builds a program and returns it with its version."""

    dims = 3

    def cgal(self):
        version = debian("CGAL", "libcgal-dev", "libgmp-dev", "libmpfr-dev")
        return self.compile("cgal3", "-frounding-math", "-lmpfr", "-lgmp"), version

    def cgal_orders(self):
        version = debian("CGAL", "libcgal-dev", "libgmp-dev", "libmpfr-dev")
        return self.compile("cgal3_orders", "-frounding-math", "-lmpfr", "-lgmp"), version

    def cgal_parallel(self):
        version = debian("CGAL", "libcgal-dev", "libgmp-dev", "libmpfr-dev")
        with_tbb = f"{version}, TBB {debian('tbb', 'libtbb-dev')}"
        flags = ["-DCGAL_LINKED_WITH_TBB", "-frounding-math", "-ltbb", "-ltbbmalloc", "-lmpfr", "-lgmp"]
        return self.compile("cgal3", *flags, name="cgal3_parallel"), with_tbb

    def geogram(self):
        flags, version = self.geogram_flags()
        return self.compile("geogram3", *flags), version

    def hxt(self):
        """Compiled according to its own instructions, with predicates that do not fuse operations."""
        tree, version = self.debian_source("gmsh")
        root = tree / "contrib" / "hxt"
        flags = [f"-I{path}" for part in HXT_SOURCES for path in (root / part / "include", root / part / "src")]
        parts = []
        for part, names in HXT_SOURCES.items():
            for name in names.split():
                parts.append(self.folder / f"{name}.o")
                if not parts[-1].exists():
                    strict = [UNFUSED, "-fno-unsafe-math-optimizations"] if part == "predicates" else []
                    options = ["-std=gnu99", "-O3", "-march=native", "-DNDEBUG", "-fopenmp", *strict]
                    call("gcc", *options, *flags, "-c", root / part / "src" / f"{name}.c", "-o", parts[-1])
        return self.compile("hxt3", *flags, *parts, "-fopenmp", "-lm"), f"of gmsh {version}"

    def tetgen(self):
        version = debian("tetgen.h", "libtet1.5-dev")
        return self.compile("tetgen3", "-DTETLIBRARY", "-ltet"), version

    def qhull(self):
        version = debian("libqhull_r", "libqhull-dev")
        return self.compile("qhull3", "-lqhull_r"), version
