"""Transforms joined to one field, and inverses."""

import numpy as np
import pytest

import tetwarp

TURN = np.array([(0.9, -0.1, 0, 3), (0.1, 0.9, 0, -4), (0, 0, 1.1, 5), (0, 0, 0, 1.0)])


@pytest.fixture
def bent(mesh):
    return tetwarp.deform(*mesh, kind="bend", amount=0.3)


@pytest.fixture
def field(volume, mesh, twisted):
    return tetwarp.displacement_field(*mesh, twisted, reference=volume, outside="nearest")


def places(field):
    """Where a field takes the voxels of its grid."""
    return field.grid.points() + field.values


@pytest.mark.parametrize("seed", range(3))
def test_matrices_join_as_their_products(seed, volume):
    random = np.random.default_rng(seed)
    links = [np.eye(4), np.eye(4), np.eye(4)]
    for link in links:
        link[:3] += 0.2 * random.standard_normal((3, 4))
    a, b, c = links
    points = volume.grid.points()

    for order, product in (("points", c @ np.linalg.inv(b) @ a), ("image", a @ np.linalg.inv(b) @ c)):
        joined = tetwarp.compose(links, order=order, inverse=[False, True, False], reference=volume)

        expected = points @ product[:3, :3].T + product[:3, 3]
        assert np.abs(places(joined) - expected).max() < 1e-4 and joined.mask.all()
    assert np.allclose(tetwarp.invert(b), np.linalg.inv(b), rtol=1e-12, atol=1e-12)


def test_meshes_move_positions_one_after_the_other(volume, mesh, twisted, bent):
    joined = tetwarp.compose([(*mesh, twisted), (*mesh, bent)], order="image", reference=volume)

    points, reached = volume.grid.points().reshape(-1, 3), True
    for deformed in (bent, twisted):
        moved = tetwarp.transform_points(points, *mesh, deformed, inverse=True)
        is_held = ~np.isnan(moved[:, :1])
        points, reached = np.where(is_held, moved, points), reached & is_held
    expected = (points - volume.grid.points().reshape(-1, 3)).astype(np.float32)
    assert np.array_equal(joined.values.reshape(-1, 3), expected)
    assert np.array_equal(joined.mask.ravel(), reached.ravel()) and 0.1 < joined.mask.mean() < 0.99


def test_the_order_of_points_is_that_of_a_list_of_resample(volume, field):
    joined = tetwarp.compose([TURN, field], order="points", reference=volume)
    reverse = tetwarp.compose([field, TURN], order="image", reference=volume)

    expected = tetwarp.resample(volume, [TURN, field])
    assert np.array_equal(joined.values, reverse.values)
    assert np.abs(tetwarp.resample(volume, joined).array - expected.array).max() < 1e-4


def test_the_inverse_of_a_mesh_takes_points_back(volume, mesh, twisted):
    inverse = tetwarp.invert(*mesh, twisted)
    inside = volume.grid.points().reshape(-1, 3)[::7]

    moved = tetwarp.transform_points(inside, *mesh, twisted)
    back = tetwarp.transform_points(moved, *inverse)

    known = ~np.isnan(back).any(axis=1)
    assert known.sum() > 500 and np.abs(back - inside)[known].max() <= 1e-9
    assert inverse.folded == inverse.inverted == 0 and 0 < inverse.largest_error < 1e-9
    assert inverse.points == len(mesh.points) + len(mesh.cells)
    joined = tetwarp.compose([(*mesh, twisted), inverse], order="points", reference=volume)
    assert np.abs(joined.values[joined.mask]).max() < 1e-4
    marked = tetwarp.compose([(*mesh, twisted)] * 2, order="points", inverse=[False, True],
                             reference=volume)
    assert np.array_equal(joined.values, marked.values)


@pytest.mark.parametrize("convention", ["resampling", "modeling"])
def test_the_inverse_of_a_field_is_found_to_its_residual(convention, volume, mesh, twisted):
    field = tetwarp.displacement_field(*mesh, twisted, reference=volume, convention=convention)
    field.values += 0.1 * (volume.grid.points() - (0, 0, 9)).astype(np.float32)
    as_volume = tetwarp.Volume(field.values, field.grid)

    with pytest.warns(RuntimeWarning, match="have no inverse"):  # what jumps at the mesh leaves gaps
        inverse = tetwarp.invert(field, threads=2)

    back = tetwarp.compose([inverse, as_volume], order="points", reference=volume)
    assert inverse.mask.mean() > 0.7 and inverse.largest_residual <= 1e-6 * min(volume.grid.spacing)
    assert np.abs(back.values[inverse.mask]).max() < 1e-4 and not inverse.values[~inverse.mask].any()
    with pytest.warns(RuntimeWarning, match="have no inverse"):
        joined = tetwarp.compose([field], order="image", inverse=[True], reference=field, threads=1)
    assert np.array_equal(joined.values, inverse.values) and np.array_equal(joined.mask, inverse.mask)


def test_what_nothing_is_taken_to_is_told_and_stays():
    """A shift by 3 voxels along x: to the first voxels of a row nothing is taken."""
    grid = tetwarp.Grid((4, 4, 10))
    field = tetwarp.Field(np.zeros((4, 4, 10, 3), np.float32), np.ones((4, 4, 10), bool), grid, "shift")
    field.values[..., 0] = 3

    with pytest.warns(RuntimeWarning, match="48 of 160 positions have no inverse: .* mask is False"):
        inverse = tetwarp.invert(field)

    assert np.array_equal(inverse.mask, np.broadcast_to(np.arange(10) >= 3, (4, 4, 10)))
    assert np.abs(inverse.values[..., 0] - np.where(inverse.mask, -3, 0)).max() < 1e-5
    assert inverse.not_inverted == 48 and "48 without an inverse" in repr(inverse)


def test_folds_are_told(single_tet):
    points, cells = single_tet
    turned = points * (1, 1, -1)

    with pytest.warns(RuntimeWarning, match="folds: 1 inverted tetrahedra, 0 of 5 points"):
        inverse = tetwarp.invert(points, cells, turned)

    assert inverse.inverted == 1 and np.array_equal(inverse.rest, turned)


def test_the_command_has_the_same_bits(volume, mesh, twisted, bent, field, command, tmp_path):
    tetwarp.write(tmp_path / "volume.vtkhdf", volume)
    tetwarp.write(tmp_path / "field.vtkhdf", field)
    for name, nodes in (("twisted", twisted), ("bent", bent)):
        tetwarp.write(tmp_path / f"{name}.vtkhdf", mesh, deformed=[nodes])
    command("compose", *(tmp_path / name for name in (
        "twisted.vtkhdf", "field.vtkhdf^-1", "bent.vtkhdf^-1")), "--like", tmp_path / "volume.vtkhdf",
        "-o", tmp_path / "joined.vtkhdf")
    command("invert", tmp_path / "bent.vtkhdf", "-o", tmp_path / "back.vtkhdf")

    files = {name: tetwarp.MeshFile(tmp_path / f"{name}.vtkhdf") for name in ("twisted", "bent", "back")}
    triples = {name: (*file.mesh, file.step(0)) for name, file in files.items()}
    with pytest.warns(RuntimeWarning, match="have no inverse"):
        joined = tetwarp.compose([triples["twisted"], field, triples["bent"]], order="image",
                                 inverse=[False, True, True], reference=volume)
    inverse = tetwarp.invert(*triples["bent"])

    assert np.array_equal(joined.values, tetwarp.read(tmp_path / "joined.vtkhdf").array)
    assert np.array_equal(inverse.rest, triples["back"][0])
    assert np.abs(inverse.deformed - triples["back"][2]).max() < 1e-9  # a file has displacements


def test_wrong_arguments_are_named(volume, mesh, twisted, field):
    grid = {"reference": volume}
    forward = tetwarp.displacement_field(*mesh, twisted, reference=volume, convention="modeling")
    flat = np.diag([1.0, 0, 1, 1])
    for transforms, keywords, message in (
            ([TURN], {"order": "first"}, "order: expected image or points, got 'first'"),
            ([], grid, "transforms: expected at least one"), (5, grid, "transforms: expected a list"),
            ([TURN], {}, "reference: expected a grid"),
            ([TURN], {"inverse": [], **grid}, "inverse: expected 1 flags, one per transform, got 0"),
            ([TURN], {"inverse": [1], **grid}, r"inverse\[0\]: expected True or False"),
            ([TURN, forward], grid, r"transforms\[1\]: .* or tetwarp.invert"),
            ([volume], {"inverse": [True], **grid}, r"transforms\[0\]: expected displacements"),
            ([(*mesh, twisted[1:])], grid, r"transforms\[0\]: deformed: expected \d+ rows"),
            ([np.eye(3)], grid, r"transforms\[0\]: expected a Field"),
            ([flat], {"inverse": [True], **grid}, r"transforms\[0\]: its matrix is singular"),
            ([TURN], {"threads": -1, **grid}, "threads: -1")):
        with pytest.raises(ValueError, match=message):
            tetwarp.compose(transforms, **{"order": "image", **keywords})
    for arguments, keywords, message in (
            ((flat,), {}, "transform: its matrix is singular"), ((volume,), {}, "transform: expected disp"),
            ((TURN,), grid, "reference: is for fields"), ((*mesh, twisted), grid, "reference: is for"),
            (mesh, {}, "deformed: "), ((mesh.points, None, twisted), {}, "cells: ")):
        with pytest.raises(ValueError, match=message):
            tetwarp.invert(*arguments, **keywords)
    with pytest.raises(TypeError, match="order"):
        tetwarp.compose([TURN], **grid)
    with pytest.raises(tetwarp.Cancelled):
        tetwarp.invert(field, progress=lambda fraction: False)
    with pytest.raises(ZeroDivisionError):
        tetwarp.compose([TURN], order="image", **grid, progress=lambda fraction: 1 / 0)
