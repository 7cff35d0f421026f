"""Installs the peers, from public packages alone, in the folder of the benchmark."""

import os
import pathlib
import shutil
import subprocess
import tarfile
import zipfile
from dataclasses import dataclass

HERE = pathlib.Path(__file__).resolve().parent
NATIVE = HERE / "native"
RUST = HERE / "rust"
CXX = ["g++", "-std=c++20", "-O3", "-march=native", "-DNDEBUG"]
CGAL_PACKAGES = ["libcgal-dev", "libgmp-dev", "libmpfr-dev"]
PYTHON_BUILD_PACKAGES = ["cython", "numpy", "setuptools", "setuptools-scm", "wheel", "scikit-build-core", "cmake", "ninja"]
# Error-free transformations break where the compiler fuses a product and a sum.
UNFUSED = "-ffp-contract=off"


class Missing(Exception):
    """Why a peer cannot be installed."""


@dataclass
class Peer:
    """A program that reads points and writes triangles; without `program` it is not here, for a `reason`."""

    name: str
    source: str
    exact: str
    version: str = ""
    program: object = None
    reason: str = ""
    # Reads LAS alone, and says neither a time of its own nor a count.
    whole_only: bool = False

    def command(self, points, triangles):
        if self.whole_only:
            return [self.program, "translate", points, f"{triangles}.ply", "delaunay", "--writers.ply.faces=true"]
        return [self.program, points, triangles]

    def as_json(self):
        return {key: getattr(self, key) for key in ("name", "source", "version", "exact", "reason")}


def call(*command, **options):
    """Runs a step of an installation."""
    try:
        done = subprocess.run([str(w) for w in command], capture_output=True, text=True, timeout=900, **options)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise Missing(str(error)) from error
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        # Python says it last, compilers first.
        raised = [line for line in reversed(lines) if "Error: " in line]
        errors = raised or [line for line in lines if "rror" in line] or lines or ["failed"]
        raise Missing(f"{pathlib.Path(command[0]).name}: {errors[0].strip()[:160]}")
    return done.stdout.strip()


def apt_install(*packages):
    if os.geteuid():
        raise Missing(f"needs root: apt-get install {' '.join(packages)}")
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    try:
        call("apt-get", "install", "-y", "-q", *packages, env=environment)
    except Missing:
        call("apt-get", "update", "-q")
        call("apt-get", "install", "-y", "-q", *packages, env=environment)


def debian_version(package):
    return call("dpkg-query", "-W", "-f", "${Version}", package)


class Installer:
    """Puts peers and their parts under `folder`."""

    def __init__(self, folder):
        self.folder = folder / "peers"
        self.folder.mkdir(parents=True, exist_ok=True)
        self.rust_programs = self.folder / "cargo" / "release"

    def compile(self, name, *flags):
        """A program of native/NAME.cpp."""
        program = self.folder / name
        sources = [NATIVE / f"{name}.cpp", NATIVE / "points.hpp", HERE / "peers.py"]
        if program.exists() and program.stat().st_mtime > max(source.stat().st_mtime for source in sources):
            return program
        call(*CXX, sources[0], "-o", program, *flags)
        return program

    def cgal(self):
        if not pathlib.Path("/usr/include/CGAL").exists():
            apt_install(*CGAL_PACKAGES)
        return self.compile("cgal", "-frounding-math", "-lmpfr", "-lgmp"), debian_version("libcgal-dev")

    def python(self):
        """The interpreter of an environment with what packages need before pip hands out their sources."""
        python = self.folder / "venv" / "bin" / "python"
        if not python.exists():
            call("python3", "-m", "venv", self.folder / "venv")
        call(python, "-m", "pip", "install", "-q", *PYTHON_BUILD_PACKAGES)
        return python

    def package(self, name, *flags):
        """Folder with what the Python package `name` is made of, and its version."""
        place = self.folder / f"package-{name}"
        if not place.exists():
            part = self.folder / f"part-{name}"
            shutil.rmtree(part, ignore_errors=True)
            call(self.python(), "-m", "pip", "download", "-q", "--no-deps", *flags, "-d", part, name)
            (archive,) = part.iterdir()
            if archive.suffix == ".whl":
                zipfile.ZipFile(archive).extractall(part)
            else:
                tarfile.open(archive).extractall(part, filter="data")
            os.replace(part, place)
        (archive,) = [path for path in place.iterdir() if path.suffix in (".whl", ".gz")]
        return place, archive.name.removesuffix(".tar.gz").split("-")[1]

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
        place, version = self.package("geogram", "--only-binary", "geogram")
        libraries = place / "geogram.libs"
        tbb = next(libraries.glob("libtbb*"))
        link = [f"-L{place / 'lib64'}", "-lgeogram", tbb, f"-Wl,-rpath,{libraries}", "-fopenmp", "-ldl", "-lpthread"]
        said = (place / "lib64" / "pkgconfig" / "geogram1.pc").read_text()
        number = said.split("Version:")[1].split()[0]
        program = self.compile("geogram", f"-I{place / 'include' / 'geogram1'}", *link)
        return program, f"{number} (PyPI geogram {version}, its library as built there)"

    def build_rust(self):
        """All crates at once, and what makes the inputs."""
        flags = {**os.environ, "RUSTFLAGS": "-C target-cpu=native"}
        target = ["--target-dir", self.folder / "cargo"]
        call("cargo", "build", "--release", "--locked", "--quiet", *target, cwd=RUST, env=flags)

    def crate(self, name):
        lock = (RUST / "Cargo.lock").read_text()
        return self.rust_programs / name, lock.split(f'name = "{name}"\nversion = "')[1].split('"')[0]

    def pdal(self):
        if not shutil.which("pdal"):
            apt_install("pdal")
        return shutil.which("pdal"), debian_version("pdal")

    def delabella(self):
        raise Missing("in no public registry (Debian, crates.io, PyPI, npm)")


def install(installer, wanted):
    """All peers whose names are in `wanted` (all if it is empty), those that cannot be installed with the reason."""
    peers = [
        Peer("CGAL", "Debian", "yes"),
        Peer("Triangle", "PyPI", "yes"),
        Peer("Geogram", "PyPI", "yes"),
        Peer("CDT", "PyPI", "adaptive"),
        Peer("delaunator", "crates.io", "orientation only"),
        Peer("spade", "crates.io", "yes"),
        Peer("startin", "crates.io", "yes"),
        Peer("PDAL", "Debian", "no", whole_only=True),
        Peer("Delabella", "none", "adaptive"),
    ]
    chosen = [peer for peer in peers if not wanted or peer.name.lower() in wanted]
    for peer in chosen:
        name = peer.name.lower()
        try:
            found = installer.crate(name) if peer.source == "crates.io" else getattr(installer, name)()
            peer.program, peer.version = found
        except Missing as reason:
            peer.reason = str(reason)
    return chosen
