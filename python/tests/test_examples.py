"""The examples of docstrings run, and the names of the package are documented."""

import doctest
import importlib
import inspect
import os
import pkgutil
import subprocess
import sys
from pathlib import Path

import numpy
import pytest

import tetwarp

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "python"
MODULES = [m.name for m in pkgutil.iter_modules(tetwarp.__path__) if m.name != "_core"]


@pytest.mark.parametrize("name", MODULES)
def test_docstrings_run(name):
    module = importlib.import_module(f"tetwarp.{name}")

    result = doctest.testmod(module, extraglobs={"np": numpy})

    assert result.failed == 0


def test_every_public_name_has_a_docstring():
    for name in tetwarp.__all__:
        value = getattr(tetwarp, name)
        if not isinstance(value, dict):
            assert inspect.getdoc(value), name


@pytest.mark.parametrize("name, written", [
    ("warp_head", ["bent.nii.gz", "field.nii.gz", "head.nii.gz"]),
    ("simulate_warp", [f"orange_{number}.nii.gz" for number in (1, 2, 3, 4)]),
])
def test_examples_run(name, written, tmp_path):
    if not EXAMPLES.exists():
        pytest.skip("no folder examples beside the tests")
    package = str(Path(tetwarp.__file__).parents[1])

    done = subprocess.run(
        [sys.executable, EXAMPLES / f"{name}.py"], cwd=tmp_path, text=True, capture_output=True,
        env=os.environ | {"PYTHONPATH": package}, check=False,
    )

    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == written
    assert "WarpResult" in done.stdout


def test_nodes_are_registered():
    if not EXAMPLES.exists():
        pytest.skip("no folder examples beside the tests")

    done = subprocess.run(
        [sys.executable, EXAMPLES / "register_nodes.py"], text=True, capture_output=True,
        env=os.environ | {"PYTHONPATH": str(Path(tetwarp.__file__).parents[1])}, check=False,
    )

    assert done.returncode == 0, done.stderr
    error = float(done.stdout.split("found with an error of ")[1].split(",")[0])
    assert error < 0.005


def test_the_module_has_stubs():
    folder = tetwarp.__path__[0]
    stub = open(f"{folder}/_core.pyi", encoding="utf8").read()

    assert "class Warper" in stub
    assert open(f"{folder}/py.typed", encoding="utf8").read() == ""
