"""Fields of deformations, owners, and points."""

import numpy as np
import pytest

import tetwarp


def test_owners_are_those_of_the_warp(volume, mesh, twisted):
    owners = tetwarp.rasterize(twisted, mesh.cells, reference=volume)

    expected = tetwarp.warp(volume, *mesh, twisted, outputs="owner").owner
    assert np.array_equal(owners, expected)
    assert owners.min() == -1 and owners.max() > 50


def test_closed_shapes_own_their_faces(single_tet):
    points, cells = single_tet

    owners = tetwarp.rasterize(points, cells, shape=(4, 4, 4))

    k, j, i = np.indices((4, 4, 4))
    assert np.array_equal(owners == 0, i + j + k <= 3)


def test_fields_are_those_of_the_warp(volume, mesh, twisted):
    names = ("displacement", "jacobian", "strain", "forward", "mask")
    result = tetwarp.warp(volume, *mesh, twisted, outputs=names)

    back = tetwarp.displacement_field(*mesh, twisted, reference=volume)
    ahead = tetwarp.displacement_field(*mesh, twisted, reference=volume, convention="modeling")
    jacobian = tetwarp.jacobian_determinant(*mesh, twisted, reference=volume.grid)
    strain = tetwarp.strain(*mesh, twisted, reference=result)

    assert np.array_equal(back, result.displacement)
    assert np.array_equal(back.mask, result.mask == 1)
    assert np.array_equal(ahead, result.forward)
    assert np.array_equal(jacobian, result.jacobian)
    assert np.array_equal(strain, result.strain)
    assert "tetwarp_jacobian" in repr(jacobian)


def test_the_mask_of_a_modeling_field_is_of_the_rest_mesh(single_tet):
    points, cells = single_tet

    field = tetwarp.displacement_field(points, cells, points + 50, shape=(4, 4, 4),
                                       convention="modeling")

    assert field.mask.sum() == 20
    assert np.array_equal(field.values[field.mask], np.full((20, 3), 50, np.float32))


def test_points_have_the_owners_of_the_warp(volume, mesh, twisted):
    owners = tetwarp.rasterize(twisted, mesh.cells, reference=volume)
    centers = volume.grid.points().reshape(-1, 3)

    rest, found = tetwarp.transform_points(centers, *mesh, twisted, inverse=True,
                                           reference=volume, return_owners=True)

    assert np.array_equal(found.reshape(owners.shape), owners)
    field = tetwarp.displacement_field(*mesh, twisted, reference=volume)
    moved = (rest - centers).reshape(field.values.shape)
    assert np.isnan(moved[~field.mask]).all()
    assert np.abs(moved - field.values)[field.mask].max() < 1e-3  # float32 of positions in 1e2 mm


def test_points_go_there_and_back(mesh, twisted):
    random = np.random.default_rng(3)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    points = random.uniform(low, high, (500, 3))

    there = tetwarp.transform_points(points, *mesh, twisted)
    back = tetwarp.transform_points(there, *mesh, twisted, inverse=True)

    assert not np.isnan(there).any()
    assert np.abs(back - points).max() < 1e-9 * np.abs(high - low).max()


def test_points_of_a_mesh_at_rest_stay(mesh):
    inside = mesh.points.mean(axis=0) + np.arange(30).reshape(10, 3)

    assert np.array_equal(tetwarp.transform_points(inside, *mesh, mesh.points), inside)


def test_points_that_nothing_holds_are_told(single_tet):
    points, cells = single_tet
    outside = [(9, 9, 9), (np.nan, 0, 0), (0.5, 0.5, 0.5)]

    moved, owners = tetwarp.transform_points(outside, points, cells, points + 1,
                                             return_owners=True)

    assert owners.tolist() == [-1, -1, 0]
    assert np.isnan(moved[:2]).all() and moved[2].tolist() == [1.5, 1.5, 1.5]
    zeros = tetwarp.transform_points(outside, points, cells, points, default_value=0)
    assert zeros[0].tolist() == [0, 0, 0]


def test_the_first_of_two_folded_tetrahedra_moves_a_point():
    points = np.array([(0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 3)] * 2, float)
    moved = points + np.repeat([[1.0, 0, 0], [2, 0, 0]], 4, axis=0)

    for cells, step in (([(4, 5, 6, 7), (0, 1, 2, 3)], 2), ([(0, 1, 2, 3), (4, 5, 6, 7)], 1)):
        result = tetwarp.transform_points([(1, 1, 1.0)], points, cells, moved)
        assert result.tolist() == [[1 + step, 1, 1]]


@pytest.mark.parametrize("keywords, text", [
    (dict(), "reference: expected a grid"),
    (dict(reference=tetwarp.Grid((2, 2, 2)), shape=(2, 2, 2)), "reference: it has a grid"),
    (dict(shape=(2, 2, 2), convention="forward"), "convention: expected resampling or modeling"),
])
def test_errors_name_the_argument(keywords, text, single_tet):
    points, cells = single_tet
    with pytest.raises(ValueError, match=text):
        tetwarp.displacement_field(points, cells, points, **keywords)


def test_points_in_hexahedra_have_the_owners_of_the_warp(volume):
    mesh = tetwarp.lattice_mesh(volume, cells=3, hexahedra=True)
    bent = tetwarp.deform(*mesh, kind="bend", amount=0.5)
    owners = tetwarp.rasterize(bent, mesh.cells, reference=volume)
    centers = volume.grid.points().reshape(-1, 3)

    rest, found = tetwarp.transform_points(centers, *mesh, bent, inverse=True, reference=volume,
                                           return_owners=True)

    assert np.array_equal(found.reshape(owners.shape), owners)
    field = tetwarp.displacement_field(*mesh, bent, reference=volume)
    moved = (rest - centers).reshape(field.values.shape)
    assert np.abs(moved - field.values)[field.mask].max() < 1e-3  # float32 of positions in 1e2 mm


@pytest.mark.parametrize("exponent", [-300, -40, 40, 300])
def test_a_power_of_two_of_all_lengths_changes_no_bit(exponent, volume, mesh, twisted):
    scale = 2.0**exponent
    affine = volume.affine * ((scale,), (scale,), (scale,), (1,))
    wanted = ("owner", "jacobian", "strain")
    points = volume.grid.points().reshape(-1, 3)[::97]

    warped = tetwarp.warp(volume.array, scale * mesh.points, mesh.cells, scale * twisted,
                          affine=affine, outputs=wanted)
    moved, owners = tetwarp.transform_points(
        scale * points, scale * mesh.points, mesh.cells, scale * twisted, return_owners=True)

    expected = tetwarp.warp(volume, *mesh, twisted, outputs=wanted)
    assert np.array_equal(warped.volume, expected.volume)
    for name in wanted:
        assert np.array_equal(warped.extras[name], expected.extras[name]), name
    there, same_owners = tetwarp.transform_points(points, *mesh, twisted, return_owners=True)
    assert np.array_equal(owners, same_owners)
    assert np.array_equal(moved / scale, there, equal_nan=True)


def test_points_that_are_no_places_have_no_owner(mesh, twisted, volume):
    odd = [(np.nan, 0, 0), (0, np.inf, 0), (0, 0, -np.inf), (1e300, 0, 0), (-1e308, 1e308, 5)]
    for reference in (None, volume):
        moved, owners = tetwarp.transform_points(
            odd, *mesh, twisted, reference=reference, return_owners=True)
        assert np.isnan(moved).all() and (owners == -1).all()


@pytest.mark.parametrize("outside", [{"outside": "nearest"}, {"outside": "falloff", "falloff": 30.0}])
def test_displacements_outside_are_those_of_the_warp(outside, volume, mesh, twisted):
    field = tetwarp.displacement_field(*mesh, twisted, reference=volume, **outside)
    usual = tetwarp.displacement_field(*mesh, twisted, reference=volume)
    warped = tetwarp.warp(volume, *mesh, twisted, outputs=("displacement", "mask"), **outside)

    assert np.array_equal(field.values, warped.displacement)
    assert np.array_equal(field.mask, warped.mask.astype(bool))
    assert np.array_equal(field.values[field.mask], usual.values[field.mask])
    assert (field.values[~field.mask] != 0).any() and (usual.values[~field.mask] == 0).all()
    for call in (
        lambda: tetwarp.displacement_field(
            *mesh, twisted, reference=volume, convention="modeling", **outside),
        lambda: tetwarp.strain(*mesh, twisted, reference=volume, **outside),
        lambda: tetwarp.rasterize(*mesh, reference=volume, **outside),
    ):
        with pytest.raises((ValueError, TypeError), match="outside"):
            call()


GRID = tetwarp.Grid((6, 7, 8), (1.0, 1.5, 2), (3, -2, 5), ((0, -1, 0), (1, 0, 0), (0, 0, 1)))


def _in_world(ijk):
    return np.array(GRID.origin) + (np.array(ijk) * GRID.spacing) @ np.array(GRID.direction).T


@pytest.mark.parametrize("hexahedra", [False, True])
def test_fractions_of_a_box_are_products_of_lengths(hexahedra):
    """In indices the box is [0.25, 4.75] x [-3, 2.125] x [1.5, 99]: it leaves the grid on two sides."""
    unit, cells = tetwarp.lattice_mesh(np.ones((2, 2, 2)), cells=1, hexahedra=hexahedra)
    unit = (unit - unit.min(axis=0)) / np.ptp(unit, axis=0)
    low, high = np.array([(0.25, -3, 1.5), (4.75, 2.125, 99)])

    filled = tetwarp.rasterize(_in_world(low + unit * (high - low)), cells, reference=GRID,
                               fractions=True)

    lengths = [np.clip(np.minimum(n + 0.5, b) - np.maximum(n - 0.5, a), 0, 1)
               for n, a, b in zip(map(np.arange, GRID.shape[::-1]), low, high)]
    expected = np.einsum("i,j,k->kji", *lengths)
    assert filled.dtype == np.float64 and filled.shape == GRID.shape
    assert np.abs(filled - expected).max() < 1e-5  # nodes are rounded to 2^-20 voxel


def test_fractions_sum_to_the_volumes_of_the_cells_and_overlaps_add():
    random = np.random.default_rng(4)
    points = _in_world(random.uniform(0, 5, (30, 3)))
    cells = np.array([random.permutation(30)[:4] for _ in range(40)])  # also inverted ones
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    volumes = np.abs(np.linalg.det(edges)) / 6 / np.prod(GRID.spacing)

    each = [tetwarp.rasterize(points, cells[n:n + 1], reference=GRID, fractions=True)
            for n in range(len(cells))]
    whole = tetwarp.rasterize(points, cells, reference=GRID, fractions=True)

    assert np.allclose([part.sum() for part in each], volumes, rtol=1e-4, atol=1e-5)
    assert np.allclose(whole, sum(each), rtol=0, atol=1e-12) and whole.max() > 1.2
    owners = tetwarp.rasterize(points, cells, reference=GRID)
    assert (whole[owners >= 0] > 0).all() and np.max(each) < 1 + 1e-12
    with pytest.raises(ValueError, match=r"cells: .*split_ten_nodes\(cells\)"):
        tetwarp.rasterize(points, [range(10)], reference=GRID, fractions=True)
