"""The types of the package and of its examples hold for mypy, where it is installed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import tetwarp

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = Path(tetwarp.__file__).parent


@pytest.fixture
def sources(tmp_path):
    """The package with its stubs, and the examples."""
    if not (ROOT / "examples").exists():
        pytest.skip("no folder examples beside the tests")
    wanted = [f for f in PACKAGE.iterdir() if f.suffix in (".py", ".pyi", ".typed")]
    (tmp_path / "tetwarp").mkdir()
    for file in wanted:
        shutil.copy(file, tmp_path / "tetwarp" / file.name)
    for file in (ROOT / "examples" / "python").glob("*.py"):
        shutil.copy(file, tmp_path)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def test_mypy_finds_nothing(sources):
    pytest.importorskip("mypy")

    done = subprocess.run([sys.executable, "-m", "mypy", "."], cwd=sources, text=True,
                          capture_output=True, check=False,
                          env=os.environ | {"MYPYPATH": str(sources)})

    assert done.returncode == 0, done.stdout + done.stderr
