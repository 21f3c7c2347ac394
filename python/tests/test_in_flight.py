"""Steps of a Warper that begin before others are finished."""

import gc
import weakref

import numpy as np
import pytest

import tetwarp

NAMES = ("mask", "owner", "jacobian")


@pytest.fixture
def steps(mesh):
    return [tetwarp.deform(*mesh, kind="random", amount=0.1, seed=n) for n in range(1, 6)]


@pytest.fixture
def expected(volume, mesh, steps):
    with tetwarp.Warper(volume, *mesh) as warper:
        return [warper(step, outputs=NAMES) for step in steps]


def same(result, expected):
    return np.array_equal(result.volume, expected.volume) and all(
        np.array_equal(result.extras[name], expected.extras[name]) for name in NAMES)


@pytest.mark.parametrize("gives_out", [False, True])
def test_steps_in_flight_have_the_bits_of_single_ones(gives_out, volume, mesh, steps, expected):
    outs = [np.empty_like(volume.array) for _ in range(2)] if gives_out else [None] * 2
    found = []
    with tetwarp.Warper(volume, *mesh) as warper:
        for number, step in enumerate(steps):
            moved = step.copy()
            warper.begin_step(moved, out=outs[number % 2], outputs=NAMES)
            moved[:] = np.nan  # it has been read
            if warper.steps_in_flight == 2:
                found.append(warper.finish_step())
                assert same(found[-1], expected[number - 1])
                assert not gives_out or found[-1].volume is outs[(number - 1) % 2]
        found.append(warper.finish_step())
        assert same(found[-1], expected[-1]) and warper.steps_in_flight == 0
        assert warper.report["counts"]["covered"] == sum(r.mask.sum() for r in expected)

    assert [result.report["step"] for result in found] == list(range(5))
    assert [r.report["counts"] for r in found] == [r.report["counts"] for r in expected]


def test_arrays_of_a_step_live_until_it_is_finished(volume, mesh, steps, expected):
    warper = tetwarp.Warper(volume, *mesh)
    outs = [np.empty_like(volume.array) for _ in range(2)]
    held = [weakref.ref(out) for out in outs]
    for step in steps[:2]:
        warper.begin_step(step, out=outs.pop(0), outputs=NAMES)
    gc.collect()
    assert all(one() is not None for one in held)

    first = warper.finish_step()
    assert first.volume is held[0]() and same(first, expected[0])
    del first
    assert held[0]() is None and held[1]() is not None
    warper.close()
    gc.collect()
    assert held[1]() is None
    with pytest.raises(RuntimeError, match="Warper: it is closed"):
        warper.finish_step()


def test_what_cannot_begin_changes_nothing(volume, mesh, steps, expected):
    out = np.empty((2, *volume.shape), np.float32)
    warper = tetwarp.Warper(volume, *mesh)
    with pytest.raises(RuntimeError, match="Warper: no step is in flight"):
        warper.finish_step()
    warper.begin_step(steps[0], out=out[0], outputs=NAMES)
    with pytest.raises(ValueError, match="out: shares memory with an output of a step in flight"):
        warper.begin_step(steps[1], out=out[0])
    inside = out[0].reshape(-1)[:2 * steps[0].size].view(np.float64).reshape(-1, 3)
    with pytest.raises(ValueError, match="deformed: shares memory with an output of a step in fli"):
        warper.begin_step(inside, out=out[1])
    with pytest.raises(ValueError, match="deformed: expected finite positions, row 0"):
        warper.begin_step(np.full_like(steps[0], np.nan))
    with pytest.raises(RuntimeError, match="Warper: a step is in flight; finish it first"):
        warper(steps[1])
    warper.begin_step(steps[1], out=out[1], outputs=NAMES)
    with pytest.raises(RuntimeError, match="Warper: two steps are in flight; finish one first"):
        warper.begin_step(steps[2])

    assert same(warper.finish_step(), expected[0]) and same(warper.finish_step(), expected[1])


def test_an_error_is_that_of_its_own_step(volume, mesh, steps, expected):
    far = steps[1].copy()
    far[0, 0] = 1e300
    warper = tetwarp.Warper(volume, *mesh)
    warper.begin_step(steps[0], outputs=NAMES)
    warper.begin_step(far, outputs=NAMES)

    assert same(warper.finish_step(), expected[0])
    warper.begin_step(steps[2], outputs=NAMES)
    with pytest.raises(ValueError, match=r"^deformed positions: .* or over 2\^40 voxels"):
        warper.finish_step()
    assert same(warper.finish_step(), expected[2]) and warper.steps_in_flight == 0


class Stop(Exception):
    pass


@pytest.mark.parametrize("before", [0, 1])
@pytest.mark.parametrize("raises", [False, True])
def test_a_step_that_is_ended_while_it_begins_has_not_begun(
        before, raises, volume, mesh, steps, expected):
    def progress(fraction):
        if raises:
            raise Stop
        return False

    warper = tetwarp.Warper(volume, *mesh)
    for step in steps[:before]:
        warper.begin_step(step, outputs=NAMES)
    with pytest.raises(Stop if raises else tetwarp.Cancelled):
        warper.begin_step(steps[3], progress=progress)

    assert warper.steps_in_flight == before
    warper.begin_step(steps[2], outputs=NAMES)
    for number in [*range(before), 2]:
        assert same(warper.finish_step(), expected[number])
