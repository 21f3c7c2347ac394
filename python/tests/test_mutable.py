"""Members of objects can be set at any time: every call checks them where it uses them. A law over
all objects whose members are arrays, all members, and all calls that take such an object."""

import dataclasses
import warnings

import numpy as np
import pytest

import tetwarp

GRID = tetwarp.Grid((6, 5, 4), spacing=(1, 2, 3))
SAMPLES = np.arange(120, dtype=np.float32).reshape(GRID.shape)
MESH = tetwarp.lattice_mesh(SAMPLES, cells=2, affine=GRID.affine)


def _operator(volume):
    identity = tetwarp.WarpOperator(GRID, *MESH, MESH.points)
    return identity.forward(volume)


def _write(value, path):
    tetwarp.write(path, value)
    return tetwarp.read(path).array


#: Calls that take a volume, and what of their result is compared.
CALLS = {
    "warp": lambda volume, path: tetwarp.warp(volume, *MESH, MESH.points).volume,
    "warp of two": lambda volume, path: tetwarp.warp(
        [volume, volume], *MESH, MESH.points).volumes[1],
    "forward": lambda volume, path: _operator(volume),
    "lattice_mesh": lambda volume, path: tetwarp.lattice_mesh(volume, threshold=50).points,
    "isosurface": lambda volume, path: tetwarp.isosurface(volume, 50).points,
    "write": _write,
    "write of steps": lambda volume, path: tetwarp.write(path, [volume, volume], times=[0, 1]),
}
BRIDGES = {
    "nibabel": lambda volume, path: tetwarp.to_nibabel(volume, axes="RAS").get_fdata(),
    "SimpleITK": lambda volume, path: tetwarp.volume_from(
        tetwarp.to_sitk(volume, axes="RAS"), axes="RAS").array,
}
BOOLS = SAMPLES > 3
MASKED = np.ma.masked_less(SAMPLES, 3)
BAD_SAMPLES = [SAMPLES[:2, :2, :2], SAMPLES.ravel(), np.zeros((40, 50, 60)), SAMPLES[0], None, 5, "a",
               [], SAMPLES.astype(complex), BOOLS, MASKED, list(MASKED), SAMPLES.transpose()]
BAD_GRIDS = [tetwarp.Grid((400, 400, 400)), tetwarp.Grid((4, 5, 6)), None, GRID.shape, "a"]
GOOD_SAMPLES = [SAMPLES.tolist(), np.asfortranarray(SAMPLES), SAMPLES[::-1], SAMPLES.astype(">f4")]


@pytest.mark.parametrize("name", [*CALLS, *BRIDGES])
def test_members_of_a_volume_are_checked_where_they_are_used(name, tmp_path):
    if name in BRIDGES:
        pytest.importorskip(name)
    call = (CALLS | BRIDGES)[name]
    bad = [("array", value) for value in BAD_SAMPLES] + [("grid", value) for value in BAD_GRIDS]

    for member, value in bad:
        if name == "forward" and (member == "grid" or value is BOOLS):
            continue  # it takes the array alone, of any numbers
        volume = tetwarp.Volume(SAMPLES.copy(), GRID)
        setattr(volume, member, value)
        with pytest.raises(ValueError) as caught:
            call(volume, tmp_path / "a.vtkhdf")
        assert "\n" not in str(caught.value), (member, value)
    assert not list(tmp_path.iterdir())
    volume = tetwarp.Volume(SAMPLES.copy(), GRID)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # NumPy no longer likes it
        volume.array.shape = (4, 5, 6)
    with pytest.raises(ValueError):
        call(volume, tmp_path / "a.vtkhdf")


@pytest.mark.parametrize("name", [*CALLS, *BRIDGES])
def test_members_that_fit_are_as_those_of_a_new_volume(name, tmp_path):
    if name in BRIDGES:
        pytest.importorskip(name)
    call = (CALLS | BRIDGES)[name]

    for number, value in enumerate(GOOD_SAMPLES):
        volume = tetwarp.Volume(np.zeros_like(SAMPLES), GRID)
        volume.array = value
        given = call(volume, tmp_path / f"{number}a.vtkhdf")
        expected = call(tetwarp.Volume(value, GRID), tmp_path / f"{number}b.vtkhdf")
        assert np.array_equal(given, expected), number


def test_members_of_fields_and_results_are_checked_where_they_are_written(tmp_path):
    path = tmp_path / "a.vtkhdf"
    for value in (SAMPLES[:2], None, np.zeros((60, 50, 40, 3), np.float32)):
        field = tetwarp.strain(*MESH, MESH.points, reference=GRID)
        field.values = value
        with pytest.raises(ValueError, match="value"):
            tetwarp.write(path, field)
        result = tetwarp.warp(tetwarp.Volume(SAMPLES, GRID), *MESH, MESH.points, outputs="owner")
        result.extras["owner"] = value
        with pytest.raises(ValueError):
            tetwarp.write(path, result)
    for member, value in {"names": (), "nifti": (), "volumes": (SAMPLES, SAMPLES)}.items():
        result = tetwarp.warp(tetwarp.Volume(SAMPLES, GRID), *MESH, MESH.points)
        setattr(result, member, value)
        with pytest.raises(ValueError, match="value: expected a name and a header"):
            tetwarp.write(path, result)
    field = tetwarp.strain(*MESH, MESH.points, reference=GRID)
    field.grid = tetwarp.Grid((60, 50, 40))
    with pytest.raises(ValueError, match="value"):
        tetwarp.write(path, field)

    assert not list(tmp_path.iterdir())


def _problem():
    """Two bodies, a contact, and all other rows that a problem can have."""
    both = np.hstack([np.eye(3), -np.eye(3)])
    return tetwarp.ContactProblem(
        system=np.eye(6), jacobian=both, load=np.array([-1.0, 2, 0, 0, 0, 0]),
        velocity_offset=np.zeros(3), friction=np.array([0.5]), second_friction=np.array([0.25]),
        impulse_guess=np.zeros(3), block_start=np.array([0, 3, 6]),
        adhesion=dict(time_step=0.01, area=[1.0], stiffness=[0.0], intensity=[0.5], gap=[0, 0, 0.0],
                      energy=[0.0]),
        bilateral=dict(jacobian=np.eye(1, 6, 2), target=[0.0], compliance=[0.5]),
        rolling=dict(contact=[0], jacobian=both, rolling=[0.125], torsion=[0.25]))


def _kinds(value):
    """The same numbers, as other objects hold them."""
    if isinstance(value, tetwarp.Csr):
        dense = np.zeros(value.shape)
        rows = np.repeat(np.arange(value.shape[0]), np.diff(value.indptr))
        dense[rows, value.indices] = value.data
        return [dense, dense.tolist(), tuple(map(tuple, dense.tolist())), np.asfortranarray(dense),
                tuple(value), tuple(map(list, value))]
    if isinstance(value, dict):
        return [{key: kind for key, one in value.items() for kind in [_kinds(one)[-1]]}]
    if isinstance(value, float):
        return [np.float64(value), np.array(value)]
    if value.dtype.kind == "i":
        return [value.astype(np.int64), value.astype(">u2"), value.tolist()]
    return [value.astype(np.float32), np.repeat(value, 2)[::2], value.reshape(-1, 1), value.tolist()]


def _bits(problem):
    solution = tetwarp.solve_contacts(problem)
    return [getattr(solution, name).tobytes() for name in (
        "impulse", "velocity", "body_velocity", "bilateral_impulse", "rolling_impulse")]


MEMBERS = [f.name for f in dataclasses.fields(tetwarp.ContactProblem)
           if getattr(_problem(), f.name) is not None]


@pytest.mark.parametrize("member", MEMBERS)
def test_members_of_a_contact_problem_are_those_of_a_new_one(member, tmp_path):
    expected = _bits(_problem())
    tetwarp.write(tmp_path / "a.hdf5", _problem())

    for value in _kinds(getattr(_problem(), member)):
        problem = _problem()
        setattr(problem, member, value)
        assert _bits(problem) == expected, value
        tetwarp.write(tmp_path / "b.hdf5", problem)
        assert _bits(tetwarp.read(tmp_path / "b.hdf5")) == _bits(tetwarp.read(tmp_path / "a.hdf5"))


@pytest.mark.parametrize("member", MEMBERS)
def test_members_of_a_contact_problem_are_checked_where_they_are_used(member, tmp_path):
    for value in ("text", object(), np.zeros(3, complex), np.zeros((2, 2, 2), "M8[s]"), [[1, 2], [3]],
                  np.ma.masked_less(np.ones(3), 2), {"unknown": 1}):
        for call in (tetwarp.solve_contacts, lambda p: tetwarp.write(tmp_path / "a.hdf5", p)):
            problem = _problem()
            setattr(problem, member, value)
            with pytest.raises(ValueError) as caught:
                call(problem)
            assert member in str(caught.value) and "\n" not in str(caught.value), value
    assert not list(tmp_path.iterdir())


UPRIGHT = ((0, 0, 0), (1, 0, 0, 0))


def _tracker(**options):
    tracker = tetwarp.ContactTracker([dict(friction=0.5, stiffness=1e6, initial_intensity=1)],
                                     **options)
    tracker.begin_step(dict(keys=[(0, 0, 1, 0)], point_a=[(0.0, 0, 0)], point_b=[(0.0, 0, 0)],
                            normal=[(0.0, 0, 1)], area=[0.5]), [UPRIGHT, UPRIGHT], 0.01)
    return tracker


def test_a_tracker_checks_what_it_fills_and_continues():
    problem = _problem()
    for member in ("second_friction", "impulse_guess", "adhesion", "bilateral", "rolling"):
        setattr(problem, member, None)
    problem.jacobian = np.zeros((6, 6)).tolist()
    with pytest.raises(ValueError, match="expected a jacobian of 3 rows"):
        _tracker().fill(problem)
    table = _tracker().records.table
    for member, column in table.items():
        others = [None, column.tolist(), column[:0], np.repeat(column, 2, axis=0),
                  column.astype(np.float16)]
        tables = [{**table, member: other} for other in others]
        tables.append({key: value for key, value in table.items() if key != member})
        for wrong in tables:
            with pytest.raises((ValueError, TypeError)):
                tetwarp.ContactTracker([{}], records=tetwarp.ContactRecords(wrong))
    with pytest.raises(ValueError, match="records: has 19 members, expected the 18"):
        tetwarp.ContactTracker([{}], records=tetwarp.ContactRecords({**table, "more": table["area"]}))

    assert len(tetwarp.ContactTracker([{}], records=tetwarp.ContactRecords(table)).records) == 1


def test_lists_of_names_and_times_are_copies(tmp_path):
    simulator = tetwarp.Simulator(tetwarp.shipped_scene("cantilever"), threads=1)
    simulator.names.append("more")
    tetwarp.write(tmp_path / "a.vtkhdf", MESH, deformed=[MESH.points])
    file = tetwarp.MeshFile(tmp_path / "a.vtkhdf")
    file.times.append(5.0)

    with pytest.raises(ValueError, match="body: 'more' is not one of beam"):
        simulator.positions("more")
    with pytest.raises(ValueError, match="expected 0 to 0, got 1"):
        simulator.positions(1)
    with pytest.raises(ValueError, match="expected a step from 0 to 0"):
        file.step(1)


def test_the_module_compares_samples_with_their_grid(tmp_path):
    """What the package has checked, the module does not read beyond either."""
    core = tetwarp._core
    grid = tetwarp.Grid((4, 5, 6))._core()
    points, cells = MESH
    none = np.empty((0, 8), np.int32), np.empty((0, 6), np.int32)
    options = dict(interpolator="linear", label_rule="linear", label_gaussian=(1, 1), overshoot="keep",
                   antialias=False, intensity="value", quantities=[], outside="background", falloff=0,
                   default_value=0, output_grid=None, backend="auto", device=0, threads=1)
    calls = [
        lambda samples: core.lattice_mesh(samples, grid, 1, 0.0, False),
        lambda samples: core.isosurface(samples, grid, 0.5, None),
        lambda samples: core.Warper([samples], grid, points, cells, *none, **options),
        lambda samples: core.write_volumes(
            str(tmp_path / "a.vtkhdf"), grid, [dict(name="a", samples=[samples], nifti=None,
                                                    is_itk_field=False)], [], 0),
        lambda samples: core.write_volumes(
            str(tmp_path / "a.vtkhdf"), grid, [dict(name="a", samples=[good, samples], nifti=None,
                                                    is_itk_field=False)], [0, 1], 0)]
    good = np.ones((4, 5, 6), np.float32)
    good[1, 1, 1] = 0

    for call in calls[:4]:
        call(good)
    (tmp_path / "a.vtkhdf").unlink()
    for shape in ((2, 2, 2), (6, 5, 4), (4, 5), (120,), (4, 5, 6, 1, 1), (4, 5, 7)):
        for call in calls:
            with pytest.raises(ValueError, match="samples: expected the shape of the grid"):
                call(np.ones(shape, np.float32))
    with pytest.raises(ValueError, match="samples: expected steps of one type"):
        calls[4](good.astype(float))
    assert not list(tmp_path.iterdir())
