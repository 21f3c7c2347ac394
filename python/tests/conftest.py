"""Inputs that several files share, and the command `tetwarp`."""

import os
import shutil
import subprocess

import numpy as np
import pytest

import tetwarp


@pytest.fixture
def volume():
    """A torso of 32 x 24 x 20 voxels, float32."""
    return tetwarp.phantom(shape=(20, 24, 32))


@pytest.fixture
def mesh(volume):
    return tetwarp.lattice_mesh(volume, cells=4)


@pytest.fixture
def twisted(mesh):
    return tetwarp.deform(*mesh, kind="twist", amount=0.4)


@pytest.fixture
def command():
    """Runs the command; skips where there is none."""
    program = os.environ.get("TETWARP_COMMAND") or shutil.which("tetwarp")
    if not program:
        pytest.skip("no command tetwarp on PATH or in TETWARP_COMMAND")

    def run(*words, status=0):
        done = subprocess.run(
            [program, *map(str, words)], text=True, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, check=False,
        )
        assert done.returncode == status, done.stdout
        return done.stdout

    return run


@pytest.fixture
def single_tet():
    """One tetrahedron: nodes and cells."""
    points = np.array([(0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 3)], float)
    return points, np.array([(0, 1, 2, 3)])
