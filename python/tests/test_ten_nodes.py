"""Tetrahedra of ten nodes."""

import warnings

import numpy as np
import pytest

import tetwarp

GRID = tetwarp.Grid((24, 24, 24))
ENDS = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
NAMES = ("mask", "owner", "displacement", "jacobian", "gradient", "strain")


def quadratic(x):
    """A motion without folds for coordinates up to 24."""
    return np.stack([x[..., 0] + x[..., 1] ** 2 / 64 - x[..., 1] * x[..., 2] / 128,
                     x[..., 1] + x[..., 0] * x[..., 2] / 128,
                     x[..., 2] + x[..., 0] ** 2 / 64 - x[..., 1] / 8], -1)


def with_mid_nodes(points, tets):
    """The mesh with a node in the middle of every edge."""
    edges = np.sort(tets[:, ENDS].reshape(-1, 2))
    unique, place = np.unique(edges, axis=0, return_inverse=True)
    mids = place.reshape(-1, 6) + len(points)
    nodes = np.vstack([points, points[unique].mean(axis=1)])
    return tetwarp.Mesh(nodes, np.hstack([tets, mids]).astype(np.int32))


@pytest.fixture
def source():
    samples = np.random.default_rng(3).random(GRID.shape).astype(np.float32)
    return tetwarp.Volume(samples, GRID, "noise")


@pytest.fixture
def ten():
    lattice = tetwarp.lattice_mesh(np.ones((20, 20, 20), np.uint8), cells=3)
    return with_mid_nodes(np.round(lattice.points) + 2, lattice.cells)


def bent(mesh, amount, seed=5):
    return mesh.points + np.random.default_rng(seed).uniform(-amount, amount, mesh.points.shape)


def test_warps_have_the_bits_of_the_command(source, ten, tmp_path, command):
    ten.cells[3, 4:] = -1
    tetwarp.write(tmp_path / "source.vtkhdf", source)
    tetwarp.write(tmp_path / "mesh.vtkhdf", ten, deformed=[bent(ten, 0.2)])
    command("warp", tmp_path / "source.vtkhdf", tmp_path / "mesh.vtkhdf", "-o",
            tmp_path / "out.vtkhdf", "--backend", "cpu", "--outputs",
            ",".join(NAMES).replace("owner", "tet"))
    file = tetwarp.read(tmp_path / "mesh.vtkhdf")
    assert np.array_equal(file.mesh.cells, ten.cells)

    result = tetwarp.warp(source, *file.mesh, file.step(0), outputs=NAMES, backend="cpu")
    field = tetwarp.displacement_field(*file.mesh, file.step(0), reference=source, backend="cpu")

    expected = tetwarp.read(tmp_path / "out.vtkhdf", array="noise")
    assert np.array_equal(expected.array, result.volume)
    for name in NAMES:
        stored = "tetwarp_tet" if name == "owner" else f"tetwarp_{name}"
        assert np.array_equal(tetwarp.read(tmp_path / "out.vtkhdf", array=stored).array,
                              result.extras[name]), name
    assert np.array_equal(field, result.displacement)
    assert np.array_equal(tetwarp.rasterize(file.step(0), ten.cells, reference=source),
                          result.owner)
    straight = tetwarp.warp(source, ten.points, ten.cells[:, :4], file.step(0))
    assert np.array_equal(straight.volume[result.owner == 3], result.volume[result.owner == 3])
    assert not np.array_equal(straight.volume, result.volume)
    assert result.report["counts"]["voxels_straightened"] == 0


def test_a_quadratic_motion_is_reproduced(ten):
    deformed = quadratic(ten.points)

    field = tetwarp.displacement_field(*ten, deformed, reference=GRID)
    rest = GRID.points()[field.mask] + field.values[field.mask]
    inside = np.random.default_rng(1).uniform(3, 19, (500, 3))
    moved = tetwarp.transform_points(inside, *ten, deformed)
    back = tetwarp.transform_points(moved, *ten, deformed, inverse=True)
    jacobian = tetwarp.jacobian_determinant(*ten, deformed, reference=GRID)

    assert field.mask.sum() > 3000
    assert np.abs(quadratic(rest) - GRID.points()[field.mask]).max() < 1e-5  # of float32
    assert np.abs(moved - quadratic(inside)).max() < 1e-11
    assert np.nanmax(np.abs(back - inside)) < 1e-8 and np.isnan(back).any(axis=1).mean() < 0.1
    step = 1e-4
    gradient = np.stack([(quadratic(rest + step * e) - quadratic(rest - step * e)) / (2 * step)
                         for e in np.eye(3)], -1)
    assert np.allclose(jacobian.values[field.mask], np.linalg.det(gradient), atol=1e-4)


def test_straight_edges_have_the_bits_of_four_nodes(source, ten):
    deformed = np.round(bent(ten, 1.0) * 64) / 64
    for cell in ten.cells:
        deformed[cell[4:]] = deformed[cell[:4][np.array(ENDS)]].mean(axis=1)

    curved = tetwarp.warp(source, *ten, deformed, outputs=NAMES)
    straight = tetwarp.warp(source, ten.points, ten.cells[:, :4], deformed, outputs=NAMES)

    assert np.array_equal(curved.volume, straight.volume)
    assert all(np.array_equal(curved.extras[n], straight.extras[n]) for n in NAMES)


def test_points_are_those_of_the_command(ten, tmp_path, command):
    tetwarp.write(tmp_path / "mesh.vtkhdf", ten, deformed=[bent(ten, 0.4)])
    points = np.random.default_rng(2).uniform(0, 24, (50, 3))
    np.savetxt(tmp_path / "a.csv", points, "%.17g", ",", header="x,y,z", comments="")
    command("points", tmp_path / "a.csv", tmp_path / "mesh.vtkhdf", "-o", tmp_path / "b.csv")
    file = tetwarp.read(tmp_path / "mesh.vtkhdf")

    moved, owners = tetwarp.transform_points(points, *file.mesh, file.step(0), return_owners=True)

    table = np.loadtxt(tmp_path / "b.csv", delimiter=",", skiprows=1)
    assert np.array_equal(table[:, 3] == 1, owners >= 0) and 10 < (owners >= 0).sum() < 50
    assert np.array_equal(table[owners >= 0, :3], moved[owners >= 0])


def test_points_without_a_place_in_their_cell_are_told(ten):
    folded = bent(ten, 5)
    corners = np.unique(ten.cells[:, :4])
    folded[corners] = ten.points[corners]
    inside = np.random.default_rng(1).uniform(3, 19, (200, 3))

    with pytest.warns(RuntimeWarning, match=r"of 200 points are mapped by the straight tetrahedron of their cell"):
        tetwarp.transform_points(inside, *ten, folded, inverse=True)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tetwarp.transform_points(inside, *ten, bent(ten, 0.3), inverse=True)


def test_files_keep_or_split_the_cells(ten, tmp_path, command):
    cube = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float) + 30
    hexes = np.array([(0, 1, 3, 2, 4, 5, 7, 6)], np.int32) + len(ten.points)
    ten.cells[5, 4:] = -1
    mesh = tetwarp.Mesh(np.vstack([ten.points, cube]), (ten.cells, hexes))

    tetwarp.write(tmp_path / "mesh.vtkhdf", mesh, deformed=[mesh.points + 1])
    kept = tetwarp.read(tmp_path / "mesh.vtkhdf")
    split = tetwarp.read(tmp_path / "mesh.vtkhdf", ten_nodes="split")

    for part, expected in zip(kept.mesh.cells, mesh.cells):
        assert part.dtype == np.int32 and np.array_equal(part, expected)
    assert kept.mesh.cell_count == mesh.cell_count
    for part, expected in zip(split.mesh.cells, tetwarp.split_ten_nodes(mesh.cells)):
        assert np.array_equal(part, expected)
    assert split.mesh.cell_count == 8 * (len(ten.cells) - 1) + 1 + 1
    assert np.array_equal(kept.step(0), mesh.points + 1)
    assert command("info", tmp_path / "mesh.vtkhdf", "--quiet") == ""


def test_split_cells_fill_the_cells(ten):
    tets = tetwarp.split_ten_nodes(ten.cells)
    corners = ten.points[tets]
    edges = corners[:, 1:] - corners[:, :1]
    volumes = np.linalg.det(edges).reshape(-1, 8)

    whole = ten.points[ten.cells[:, 1:4]] - ten.points[ten.cells[:, :1]]
    assert np.allclose(volumes, np.linalg.det(whole)[:, None] / 8)
    surface = tetwarp.boundary_surface(*ten)
    assert np.array_equal(surface.triangles, tetwarp.boundary_surface(ten.points, tets).triangles)


def test_refusals_name_the_remedy(source, ten):
    remedy = r"tetwarp.split_ten_nodes\(cells\)"
    for keywords in (dict(antialias=True), dict(intensity="density")):
        with pytest.raises(ValueError, match=remedy):
            tetwarp.Warper(source, *ten, **keywords)
    with pytest.raises(ValueError, match=remedy):
        tetwarp.warp(source, *ten, ten.points, outputs="forward")
    with pytest.raises(ValueError, match=f"cells: tetrahedra of ten nodes.* {remedy}"):
        tetwarp.WarpOperator(source, *ten, ten.points)
    tetwarp.WarpOperator(source, ten.points, tetwarp.split_ten_nodes(ten.cells), ten.points)


def test_bad_cells_are_named(source, ten):
    with pytest.raises(ValueError, match=r"cells: expected shape \(m, 4\) or \(m, 10\)"):
        tetwarp.warp(source, ten.points, ten.cells[:, :9], ten.points)
    for wrong in (len(ten.points), -1, -7):
        for kind in (np.int32, np.int64):
            cells = ten.cells.astype(kind)
            cells[2, 7] = wrong
            with pytest.raises(ValueError, match=f"cells: .*found {wrong}"):
                tetwarp.warp(source, ten.points, cells, ten.points)
            with pytest.raises(ValueError, match=f"cells: .*found {wrong}"):
                tetwarp.transform_points(ten.points, ten.points, cells, ten.points)
    with pytest.raises(ValueError, match="ten_nodes: expected curved or split, got 'bent'"):
        tetwarp.MeshFile("a.vtkhdf", ten_nodes="bent")


def test_other_packages_take_and_give_them(ten):
    ten.cells[[1, 5], 4:] = -1
    straight = ten.cells[:, 4] < 0
    in_order = np.vstack([ten.cells[straight], ten.cells[~straight]])
    _, kinds = tetwarp._bridges._parts((ten.points, (ten.cells, np.arange(8)[None])))
    assert list(kinds) == ["tetra", "tetra10", "hexahedron"]
    assert np.array_equal(kinds["tetra"], in_order[:2, :4])
    assert np.array_equal(kinds["tetra10"], in_order[2:])
    exchanged = []
    for name, make in (("meshio", tetwarp.to_meshio), ("pyvista", tetwarp.to_pyvista)):
        try:
            __import__(name)
        except ImportError:
            continue
        exchanged.append(name)
        back = tetwarp.mesh_from(make(ten))
        assert np.array_equal(back.cells, in_order), name
        assert np.array_equal(back.points, ten.points), name
    if not exchanged:
        pytest.skip("neither meshio nor pyvista is installed")
