"""The examples of docstrings run, and the names of the package are documented."""

import doctest
import importlib
import inspect
import os
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import numpy
import pytest

import tetwarp

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "python"
MODULES = [m.name for m in pkgutil.iter_modules(tetwarp.__path__) if m.name != "_core"]


DOCTESTS = [test for name in MODULES for test in doctest.DocTestFinder().find(
    importlib.import_module(f"tetwarp.{name}"), extraglobs={"np": numpy}) if test.examples]


@pytest.mark.parametrize("test", DOCTESTS, ids=lambda test: test.name.removeprefix("tetwarp._"))
def test_docstrings_run(test):
    for example in test.examples:
        for line in re.findall(r"^import (.+)", example.source):
            for package in line.split(", "):
                pytest.importorskip(package)

    assert doctest.DocTestRunner().run(test).failed == 0


#: What has no example of its own: errors, and results that the examples of functions show.
SHOWN_ELSEWHERE = {
    "AdhesionStep", "Cancelled", "Certificate", "Collisions", "ComposedField", "ContactProblem",
    "ContactRecords", "ContactSolution", "Contacts", "Csr", "CudaError", "Field", "InverseMesh", "IoError",
    "Mesh", "StepRecord", "Surface", "TrackedContacts", "VolumeHeader", "WarpResult",
}


def test_every_public_name_has_a_docstring_and_an_example():
    for name in tetwarp.__all__:
        value = getattr(tetwarp, name)
        if not isinstance(value, dict):
            assert inspect.getdoc(value), name
            assert (">>>" in (value.__doc__ or "")) != (name in SHOWN_ELSEWHERE), name


def run_example(name, folder, *words):
    """What an example prints."""
    if not EXAMPLES.exists():
        pytest.skip("no folder examples beside the tests")
    done = subprocess.run(
        [sys.executable, EXAMPLES / f"{name}.py", *words], cwd=folder, text=True, capture_output=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}, check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("name, written", [
    ("warp_head", ["bent.nii.gz", "field.nii.gz", "head.nii.gz"]),
    ("simulate_warp", [f"orange_{number}.nii.gz" for number in (1, 2, 3, 4)]),
    ("warp_steps", ["head.nii.gz", "steps.vtkhdf"] + [f"warped_{n}.nii.gz" for n in range(4)]),
])
def test_examples_write_images(name, written, tmp_path):
    out = run_example(name, tmp_path)

    assert sorted(path.name for path in tmp_path.iterdir()) == written
    assert "WarpResult" in out
    totals = re.findall(r"sum (\S+) of the image", out)
    assert len(totals) == (4 if name == "warp_steps" else 0)
    assert all(abs(float(total) - 1) < 0.002 for total in totals)


def test_points_come_back(tmp_path):
    out = run_example("move_points", tmp_path)

    assert float(out.split("misses them by ")[1].split()[0]) < 1e-12
    assert out.startswith("20 landmarks in cells")
    before, after = (tetwarp.read(tmp_path / f"{name}.vtkhdf") for name in ("surface", "bent"))
    assert numpy.array_equal(before.triangles, after.triangles)
    assert not numpy.array_equal(before.points, after.points)


def test_solvers_agree(tmp_path):
    lines = run_example("compare_solvers", tmp_path).splitlines()

    assert lines[0] == "stack.hdf5"
    assert len(lines) == 6
    for line in lines[1:]:
        assert float(line.split("eta ")[1].split(",")[0]) <= 1e-8, line


def test_nodes_are_registered(tmp_path):
    out = run_example("register_nodes", tmp_path)

    assert float(out.split("found with an error of ")[1].split(",")[0]) < 0.005


def test_pictures_are_drawn(tmp_path):
    pytest.importorskip("matplotlib")

    run_example("pictures", tmp_path, "drawn", "warp_head", "move_points")

    names = ["python_move_points.png", "python_warp_head.png"]
    assert sorted(path.name for path in (tmp_path / "drawn").iterdir()) == names
    assert [path.name for path in tmp_path.iterdir()] == ["drawn"]


def test_the_module_has_stubs():
    folder = tetwarp.__path__[0]
    stub = open(f"{folder}/_core.pyi", encoding="utf8").read()

    assert "class Warper" in stub
    assert open(f"{folder}/py.typed", encoding="utf8").read() == ""
