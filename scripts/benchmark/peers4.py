"""The peers in 4D."""

from installer import Installer, Peer, debian
from peers3 import CGAL

# Only Qhull, with merged facets, makes diagrams. The others stop after triangulating cospherical points.
PEERS = [
    Peer(CGAL, "Debian", "yes", "cgal"),
    Peer("Qhull, merged", "Debian", "no", "qhull"),
    Peer("Qhull, Qt", "Debian", "no", "qhull", flags=("split",)),
]


class Peers4(Installer):
    """Each method builds a program and returns it with its version."""

    dims = 4

    def cgal(self):
        version = debian("CGAL", "libcgal-dev", "libgmp-dev", "libmpfr-dev")
        with_eigen = f"{version}, Eigen {debian('eigen3', 'libeigen3-dev')}"
        flags = ["-I/usr/include/eigen3", "-frounding-math", "-lmpfr", "-lgmp"]
        return self.compile("cgal4", *flags), with_eigen

    def qhull(self):
        version = debian("libqhull_r", "libqhull-dev")
        return self.compile("qhull4", "-lqhull_r"), version
