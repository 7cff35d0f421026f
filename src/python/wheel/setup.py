"""Builds the programs with cargo and puts them into the wheel beside the package."""

import json
import os
import subprocess
from pathlib import Path

from setuptools import setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parents[3]


class BuildPrograms(build_py):
    """Runs cargo before the package is collected."""

    def run(self):
        build = ["cargo", "build", "--release", "--locked", "--bins", "--manifest-path", ROOT / "Cargo.toml"]
        subprocess.run(build, check=True)
        query = ["cargo", "metadata", "--no-deps", "--format-version", "1", "--manifest-path", ROOT / "Cargo.toml"]
        metadata = json.loads(subprocess.run(query, check=True, stdout=subprocess.PIPE).stdout)
        package = next(package for package in metadata["packages"] if package["name"] == "spmesh")
        names = [target["name"] for target in package["targets"] if "bin" in target["kind"]]
        folder = Path(metadata["target_directory"]) / "release"
        # Paths from here, because wheels take no absolute ones.
        programs = [os.path.relpath(folder / name, Path.cwd()) for name in names]
        self.distribution.data_files.append(("bin", programs))
        super().run()


class PlatformWheel(bdist_wheel):
    """A wheel of this platform for any Python 3: its programs do not depend on Python."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


setup(
    packages=["spmesh"],
    package_dir={"": ".."},
    package_data={"spmesh": ["py.typed"]},
    data_files=[],
    cmdclass={"build_py": BuildPrograms, "bdist_wheel": PlatformWheel},
)
