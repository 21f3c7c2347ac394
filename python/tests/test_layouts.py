"""The same numbers give the same bits, however an array holds them: a law of every call that takes
arrays, over random inputs."""

import numpy as np
import pytest

import tetwarp

# Random numbers are multiples of 1/8 below 64: exact in every float type.


def _random(shape, seed, low=-64, high=64):
    return np.random.default_rng(seed).integers(8 * low, 8 * high, shape) / 8


def _lattice(seed):
    """A mesh of cubes of 4 voxels whose inner nodes are moved, and moved again."""
    rest, cells = tetwarp.lattice_mesh(np.ones((9, 9, 9), np.uint8), cells=2)
    rest = np.round(8 * rest) / 8 + _random(rest.shape, seed, -1, 1) / 2
    return rest, cells, rest + _random(rest.shape, seed + 1, -1, 1)


def _ten_nodes(seed):
    """Eight of its tetrahedra with middle nodes of their own, moved from the middles of the edges."""
    rest, cells, _ = _lattice(seed)
    edges = cells[:8][:, [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]].reshape(-1, 2)
    middles = rest[edges].mean(axis=1)
    new = len(rest) + np.arange(len(edges)).reshape(-1, 6)
    rest = np.vstack([rest, middles])
    return rest, np.hstack([cells[:8], new]), rest + _random(rest.shape, seed + 2, -1, 1) / 4


def _problem(seed):
    """Three bodies of a mass each, two contacts between them."""
    turn = np.linalg.qr(_random((3, 3), seed))[0]
    step = np.round(8 * turn) / 8
    jacobian = np.zeros((6, 9))
    jacobian[:3, :3], jacobian[:3, 3:6] = step, -step
    jacobian[3:, 3:6], jacobian[3:, 6:] = step, -step
    return dict(system=np.diag(np.repeat([1.0, 2, 4], 3)), jacobian=jacobian,
                load=_random(9, seed + 1, -4, 4), velocity_offset=_random(6, seed + 2, -1, 1),
                friction=np.array([0.5, 0.25]))


def _warp(samples, rest, cells, deformed):
    result = tetwarp.warp(samples, rest, cells, deformed, outputs=("owner", "jacobian"), threads=1)
    return result.volume, result.owner, result.jacobian


def _operator(samples, rest, cells, deformed):
    operator = tetwarp.WarpOperator(tetwarp.Grid((9, 9, 9)), rest, cells, deformed, threads=1)
    forward = operator.forward(samples)
    return forward, operator.adjoint(forward), operator.node_gradient(samples, forward)


def _solve(**members):
    solution = tetwarp.solve_contacts(**members)
    return solution.impulse, solution.body_velocity


def _track(points, normals, areas, keys):
    tracker = tetwarp.ContactTracker([dict(friction=0.5, stiffness=1e6, initial_intensity=1)])
    upright = (1, 0, 0, 0)
    contacts = tracker.begin_step(
        dict(keys=keys, point_a=points, point_b=points, normal=normals, area=areas),
        [((0, 0, 0), upright), ((0, 0, 1), upright)], 0.01)
    return contacts.keys, contacts.point_a, contacts.axes, tracker.records.area


def _calls():
    rest, cells, deformed = _lattice(1)
    samples = _random((9, 9, 9), 3, 0, 64)
    surface = tetwarp.boundary_surface(rest, cells)
    mesh = dict(rest=rest, cells=cells, deformed=deformed)
    ten = dict(zip(("rest", "cells", "deformed"), _ten_nodes(9)))
    return {
        "ten nodes": (_warp, dict(samples=samples, **ten)),
        "points of ten nodes": (
            lambda points, **mesh: tetwarp.transform_points(points, **mesh, return_owners=True),
            dict(points=_random((40, 3), 5, 0, 8), **ten)),
        "warp": (_warp, dict(samples=samples, **mesh)),
        "labels": (_warp, dict(samples=samples.astype(np.int16), **mesh)),
        "components": (_warp, dict(samples=_random((9, 9, 9, 2), 4), **mesh)),
        "operator": (_operator, dict(samples=samples, **mesh)),
        "points": (
            lambda points, **mesh: tetwarp.transform_points(points, **mesh, return_owners=True),
            dict(points=_random((40, 3), 5, 0, 8), **mesh)),
        "strain": (lambda **mesh: (tetwarp.strain(**mesh, shape=(9, 9, 9), threads=1).values,), mesh),
        "boundary": (tetwarp.boundary_surface, dict(points=rest, cells=cells)),
        "deform": (lambda points, cells: (tetwarp.deform(points, cells),),
                   dict(points=rest, cells=cells)),
        "isosurface": (lambda volume: tetwarp.isosurface(volume, 32), dict(volume=samples)),
        "lattice": (lambda volume: tetwarp.lattice_mesh(volume, cells=3, threshold=32),
                    dict(volume=samples)),
        "certify": (
            lambda start, end, triangles: (
                tetwarp.certify([(start, end, triangles)], threads=1).triangles,),
            dict(start=surface.points, end=_random(surface.points.shape, 6, 0, 8),
                 triangles=surface.triangles)),
        "contacts": (_solve, _problem(7)),
        "tracker": (_track, dict(points=_random((2, 3), 8), normals=np.eye(3)[1:],
                                 areas=np.array([0.5, 0.25]),
                                 keys=np.array([(0, 1, 1, 4), (0, 2, 1, 3)]))),
    }


CALLS = _calls()


def _unaligned(array):
    memory = np.zeros(array.nbytes + 1, np.uint8)
    copy = memory[1:].view(array.dtype).reshape(array.shape)
    copy[...] = array
    return copy


def _spread(array):
    wide = np.zeros(tuple(2 * n for n in array.shape), array.dtype)
    view = wide[tuple(slice(1, None, 2) for _ in array.shape)]
    view[...] = array
    return view


def _read_only(array):
    copy = array.copy()
    copy.flags.writeable = False
    return copy


LAYOUTS = {
    "fortran": np.asfortranarray,
    "negative strides": lambda a: np.flip(np.flip(a).copy()),
    "spread": _spread,
    "swapped bytes": lambda a: a.astype(a.dtype.newbyteorder()),
    "read-only": _read_only,
    "unaligned": _unaligned,
    "own class": lambda a: a.view(type("Own", (np.ndarray,), {})),
    "no masked element": lambda a: np.ma.array(a, mask=False),
}


def _same(results, expected):
    return len(results) == len(expected) and all(
        np.array_equal(a, b, equal_nan=a.dtype.kind == "f") and a.dtype == b.dtype
        for a, b in zip(results, expected))


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", CALLS)
def test_the_layout_of_an_array_changes_no_bit(name, layout):
    call, arrays = CALLS[name]
    expected = call(**arrays)

    for argument, array in arrays.items():
        assert _same(call(**{**arrays, argument: LAYOUTS[layout](array)}), expected), argument
    assert _same(call(**{key: LAYOUTS[layout](a) for key, a in arrays.items()}), expected)


@pytest.mark.parametrize("name", CALLS)
def test_the_type_of_positions_and_indices_changes_no_bit(name):
    """Samples keep their type; other numbers are read as float64 and int32."""
    call, arrays = CALLS[name]
    expected = call(**arrays)

    for argument, array in arrays.items():
        if argument in ("samples", "volume"):
            continue
        types = "f2 >f4 f4 g" if array.dtype.kind == "f" else "u1 i2 >u4 i8 u8"
        for dtype in types.split():
            other = array.astype(dtype)
            assert np.array_equal(other, array), (argument, dtype)
            assert _same(call(**{**arrays, argument: other}), expected), (argument, dtype)
        assert _same(call(**{**arrays, argument: array.tolist()}), expected), argument
