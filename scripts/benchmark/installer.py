"""Installs peers from public packages, in the folder of the benchmark."""

import os
import pathlib
import platform
import shutil
import subprocess
import tarfile
import zipfile
from dataclasses import dataclass

HERE = pathlib.Path(__file__).resolve().parent
NATIVE = HERE / "native"
RUST = HERE / "rust"
CXX = ["g++", "-std=c++20", "-O3", "-march=native", "-DNDEBUG"]
PYTHON_BUILD_PACKAGES = ["cython", "numpy", "setuptools", "setuptools-scm", "wheel", "scikit-build-core", "cmake", "ninja"]
# Error-free transformations fail if the compiler fuses a product and a sum.
UNFUSED = "-ffp-contract=off"
KEYRING = "/usr/share/keyrings/debian-archive-keyring.gpg"


class Missing(Exception):
    """The reason why a peer cannot be installed."""


@dataclass
class Peer:
    """A program that reads points and triangulates them; without `program` it is absent for a `reason`."""

    name: str
    source: str
    exact: str
    # The method of the installer that builds it, or the crate.
    recipe: str
    threads: int = 1
    # Arguments after the points, in 4D.
    flags: tuple = ()
    # Reads only LAS, and reports neither its own time nor a count.
    whole_only: bool = False
    version: str = ""
    program: object = None
    reason: str = ""

    def command(self, points, triangles):
        """The command in 2D: reads points and writes triangles."""
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
        # Python reports the error last, compilers report it first.
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


def debian(header, *packages):
    """Installs Debian packages unless `header` of the first one exists; returns its version."""
    if not pathlib.Path("/usr/include", header).exists():
        apt_install(*packages)
    return debian_version(packages[0])


class Installer:
    """Installs peers and their parts in `folder`."""

    def __init__(self, folder):
        self.folder = folder / "peers"
        self.folder.mkdir(parents=True, exist_ok=True)
        self.rust_programs = self.folder / "cargo" / "release"

    def compile(self, source, *flags, name=""):
        """Compiles native/SOURCE.cpp to a program called `name` or like the source."""
        program = self.folder / (name or source)
        sources = [NATIVE / f"{source}.cpp", *NATIVE.glob("*.hpp"), *HERE.glob("peers*.py")]
        if program.exists() and program.stat().st_mtime > max(source.stat().st_mtime for source in sources):
            return program
        call(*CXX, sources[0], "-o", program, *flags)
        return program

    def python(self):
        """The interpreter of a virtual environment with the packages for downloads of sources by pip."""
        python = self.folder / "venv" / "bin" / "python"
        if not python.exists():
            call("python3", "-m", "venv", self.folder / "venv")
        call(python, "-m", "pip", "install", "-q", *PYTHON_BUILD_PACKAGES)
        return python

    def package(self, name, *flags):
        """The folder with the unpacked Python package `name`, and its version."""
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

    def debian_source(self, name):
        """The folder with the upstream sources of a Debian package, and their version."""
        place = self.folder / f"source-{name}"
        if not place.exists():
            part = self.folder / f"part-{name}"
            shutil.rmtree(part, ignore_errors=True)
            (part / "lists" / "partial").mkdir(parents=True)
            suite = platform.freedesktop_os_release()["VERSION_CODENAME"]
            listed = f"deb-src [signed-by={KEYRING}] http://deb.debian.org/debian {suite} main\n"
            (part / "sources.list").write_text(listed)
            lists = f"-oDir::State::Lists={part / 'lists'}"
            sources = [f"-oDir::Etc::SourceList={part / 'sources.list'}", "-oDir::Etc::SourceParts=/dev/null"]
            apt = ["apt-get", "-q", lists, *sources]
            call(*apt, "update")
            call(*apt, "source", "--download-only", name, cwd=part)
            (archive,) = part.glob("*.orig.tar.*")
            tarfile.open(archive).extractall(part, filter="data")
            os.replace(part, place)
        (archive,) = place.glob("*.orig.tar.*")
        (tree,) = [path for path in place.iterdir() if path.is_dir() and path.name != "lists"]
        return tree, archive.name.split("_")[1].split(".orig")[0].split("+")[0]

    def checkout(self, name, url, variable):
        """The folder with the sources of a program that is in no registry of packages: that of the environment
        `variable`, or a clone.
        """
        given = os.environ.get(variable)
        place = pathlib.Path(given).resolve() if given else self.folder / f"checkout-{name}"
        if given and not place.is_dir():
            raise Missing(f"{variable}: {place} is no folder")
        if not place.is_dir():
            try:
                call("git", "clone", "--quiet", "--depth", "1", url, place)
            except Missing as reason:
                raise Missing(f"{reason}; set {variable} to a checkout of {url}") from reason
        return place

    def geogram_flags(self):
        """Flags that link a program to the library in Geogram's Python package, and its version."""
        place, version = self.package("geogram", "--only-binary", "geogram")
        libraries = place / "geogram.libs"
        tbb = next(libraries.glob("libtbb*"))
        link = [f"-L{place / 'lib64'}", "-lgeogram", tbb, f"-Wl,-rpath,{libraries}", "-fopenmp", "-ldl", "-lpthread"]
        said = (place / "lib64" / "pkgconfig" / "geogram1.pc").read_text()
        number = said.split("Version:")[1].split()[0]
        flags = [f"-I{place / 'include' / 'geogram1'}", *link]
        return flags, f"{number} (PyPI geogram {version}, its library as built there)"

    def build_rust(self):
        """Builds all crates, and the programs that make the inputs."""
        flags = {**os.environ, "RUSTFLAGS": "-C target-cpu=native"}
        target = ["--target-dir", self.folder / "cargo"]
        call("cargo", "build", "--release", "--locked", "--quiet", *target, cwd=RUST, env=flags)

    def crate(self, name):
        lock = (RUST / "Cargo.lock").read_text()
        return self.rust_programs / name, lock.split(f'name = "{name}"\nversion = "')[1].split('"')[0]

    def install(self, peers, wanted):
        """Installs all peers, or those named in `wanted`; a peer that cannot be installed gets the reason."""
        chosen = [peer for peer in peers if not wanted or peer.name.split()[0].strip(",").lower() in wanted]
        for peer in chosen:
            try:
                found = self.crate(peer.recipe) if peer.source == "crates.io" else getattr(self, peer.recipe)()
                peer.program, peer.version = found
            except Missing as reason:
                peer.reason = str(reason)
        return chosen
