"""A build backend: the wheel of the library (../pyproject.toml), with the project's programs as its scripts."""

import json
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]


def output_of(*command):
    return subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE).stdout


def build_programs():
    """Builds all programs; their paths."""
    manifest = ["--locked", "--manifest-path", ROOT / "Cargo.toml"]
    output_of("cargo", "build", "--release", "--bins", *manifest)
    metadata = json.loads(output_of("cargo", "metadata", "--no-deps", "--format-version", "1", *manifest))
    package = next(package for package in metadata["packages"] if package["name"] == "spmesh")
    folder = Path(metadata["target_directory"]) / "release"
    return [folder / target["name"] for target in package["targets"] if "bin" in target["kind"]]


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    programs = build_programs()
    with tempfile.TemporaryDirectory() as folder:
        python, wheel = [sys.executable, "-m"], Path(folder)
        manifest = HERE.parent / "Cargo.toml"
        output_of(*python, "maturin", "build", "--release", "--locked", "-m", manifest, "-o", wheel / "library")
        library = next((wheel / "library").glob("*.whl"))
        output_of(*python, "wheel", "unpack", library, "--dest", wheel / "tree")
        tree = next((wheel / "tree").iterdir())
        scripts = tree / f"{tree.name}.data" / "scripts"
        scripts.mkdir(parents=True)
        for program in programs:
            shutil.copy(program, scripts)
        (wheel / "packed").mkdir()
        output_of(*python, "wheel", "pack", tree, "--dest-dir", wheel / "packed")
        packed = next((wheel / "packed").iterdir())
        if "-manylinux_2_" in packed.name:
            # The tag is that of the library; programs may need a later glibc.
            glibc = glibc_of([library_file(tree), *programs])
            tag = re.sub(r"manylinux_2_\d+", f"manylinux_2_{glibc}", platform_of(packed))
            output_of(*python, "wheel", "tags", "--remove", "--platform-tag", tag, packed)
            packed = next((wheel / "packed").iterdir())
        shutil.move(packed, wheel_directory)
        return packed.name


def library_file(tree):
    return next((tree / "spmesh").glob("_native*.so"))


def platform_of(wheel):
    return wheel.stem.rsplit("-", 1)[1]


def glibc_of(files):
    """The minor version of glibc 2 that files of machine code ask for, by the names of symbols' versions in them."""
    return max(int(minor) for file in files for minor in re.findall(rb"GLIBC_2\.(\d+)", file.read_bytes()))


def build_sdist(sdist_directory, config_settings=None):
    """All sources of the project that git knows; this backend at their head."""
    version = json.loads(output_of("cargo", "metadata", "--no-deps", "--format-version", "1", "--manifest-path",
                                   HERE.parent / "Cargo.toml"))["packages"][0]["version"]
    name = f"spmesh-{version}"
    files = output_of("git", "-C", ROOT, "ls-files", "-z").decode().split("\0")
    with tempfile.TemporaryDirectory() as folder, tarfile.open(Path(sdist_directory) / f"{name}.tar.gz", "w:gz") as tar:
        for file in filter(None, files):
            tar.add(ROOT / file, f"{name}/{file}")
        head = (HERE / "pyproject.toml").read_text().replace('["."]', '["src/python/wheel"]')
        about = f"Metadata-Version: 2.1\nName: spmesh\nVersion: {version}\n"
        for file, text in [("pyproject.toml", head), ("PKG-INFO", about)]:
            (Path(folder) / file).write_text(text)
            tar.add(Path(folder) / file, f"{name}/{file}")
    return f"{name}.tar.gz"
