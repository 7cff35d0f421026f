"""The package and a user's script pass strict checkers of types, and importing the package is cheap."""

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import spmesh

HERE = Path(__file__).resolve().parent
PACKAGE = Path(spmesh.__file__).parent


class Types(unittest.TestCase):
    def check(self, module, *arguments, **more):
        if importlib.util.find_spec(module) is None:
            self.skipTest(f"{module} is not installed")
        done = subprocess.run([sys.executable, "-m", module, *map(str, arguments)], capture_output=True, text=True, **more)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_mypy_finds_no_fault(self):
        with tempfile.TemporaryDirectory() as folder:
            flags = ("--strict", "--python-version", "3.10", "--cache-dir", folder)
            environment = {**os.environ, "MYPYPATH": str(PACKAGE.parent)}
            self.check("mypy", *flags, "-p", "spmesh", "-m", "typed", cwd=HERE, env=environment)

    def test_pyright_finds_no_fault_in_a_script(self):
        with tempfile.TemporaryDirectory() as folder:
            settings = dict(include=[str(HERE / "typed.py")], extraPaths=[str(PACKAGE.parent)], typeCheckingMode="strict")
            path = Path(folder, "pyrightconfig.json")
            path.write_text(json.dumps({**settings, "pythonVersion": "3.10"}))
            self.check("pyright", "--pythonpath", sys.executable, "--project", path)

    def test_importing_loads_nothing_else(self):
        script = "import sys, spmesh; print(sorted({'numpy', 'subprocess', 'json', 'dataclasses'} & set(sys.modules)))"
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout.strip(), "[]")

    def test_the_reference_is_that_of_the_docstrings(self):
        root = HERE.parents[2]
        environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent)}
        done = subprocess.run(
            [sys.executable, root / "scripts" / "python_docs.py"], capture_output=True, text=True, env=environment, check=True
        )
        # Signatures are printed in the manner of this version.
        if sys.version_info[:2] == (3, 11):
            self.assertEqual(done.stdout, (root / "docs" / "python.md").read_text(), "run scripts/python_docs.py")

    def test_all_names_are_there(self):
        for name in spmesh.__all__:
            self.assertIs(getattr(spmesh, name), getattr(spmesh, name))
        self.assertLessEqual(set(spmesh.__all__), set(dir(spmesh)))
        self.assertEqual(set(spmesh._PLACES) | {"open", "programs"}, set(spmesh.__all__))
        self.assertRaises(AttributeError, getattr, spmesh, "no_such_name")


if __name__ == "__main__":
    unittest.main()
