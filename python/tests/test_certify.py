"""Proofs about moving surfaces."""

import numpy as np
import pytest

import tetwarp

FACES = np.array([(0, 1, 2)])
TRIANGLE = np.array([(0, 0, 0), (4, 0, 0), (0, 4, 0)], float)
NEEDLE = np.array([(1, 1, 1), (1, 1, 2), (1.5, 1, 2)])


def test_passing_through_is_found_with_its_time():
    found = tetwarp.certify([(TRIANGLE, TRIANGLE, FACES), (NEEDLE, NEEDLE - (0, 0, 4), FACES)])

    assert found.verdict == "meets" and not found
    assert found.surfaces.tolist() == [[0, 1]] and found.triangles.tolist() == [[0, 0]]
    assert found.meets.all()
    assert found.times[0, 0] <= 0.25 <= found.times[0, 1] < 0.25 + 1e-11


def test_surfaces_that_pass_by_are_free():
    aside = NEEDLE + (3, 3, 0)

    found = tetwarp.certify([(TRIANGLE, TRIANGLE, FACES), (aside, aside - (0, 0, 4), FACES)])

    assert found and found.verdict == "free" and len(found.times) == 0
    assert "free; 1 near pairs" in repr(found)


def test_a_step_of_a_simulation_is_free():
    simulator = tetwarp.Simulator(tetwarp.shipped_scene("cantilever"))
    points, triangles = simulator.surface("beam")

    simulator.step(2)

    moved = simulator.surface("beam").points
    assert not np.array_equal(points, moved)
    assert tetwarp.certify([(points, moved, triangles)])


@pytest.mark.parametrize("surface, message", [
    ((TRIANGLE, FACES), r"surfaces\[0\]: expected \(start, end, triangles\)"),
    ((TRIANGLE, NEEDLE[:2], FACES), r"surfaces\[0\]: end: expected 3 rows"),
    ((TRIANGLE, TRIANGLE, FACES + 1), r"surfaces\[0\]: triangles: expected numbers of nodes"),
    ((TRIANGLE * np.nan, TRIANGLE, FACES), "surface 0 at the start: point 0 has a coordinate"),
])
def test_bad_arguments_are_named(surface, message):
    with pytest.raises(ValueError, match=message):
        tetwarp.certify([surface])
