"""Images and meshes of other packages, as far as these are installed."""

import sys
import types

import numpy as np
import pytest

import tetwarp

DIRECTION = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))


@pytest.fixture(params=[(), (2,), (3,), (6,), (9,)], ids=str)
def turned(request):
    """A volume on a turned grid of three different lengths."""
    array = np.random.default_rng(1).random((3, 4, 5, *request.param)).astype(np.float32)
    return tetwarp.Volume(array, tetwarp.Grid((3, 4, 5), (1, 2, 3), (10, 20, 30), DIRECTION))


@pytest.mark.parametrize("axes", ["RAS", "LPS"])
def test_nibabel_there_and_back(turned, axes):
    pytest.importorskip("nibabel")

    image = tetwarp.to_nibabel(turned, axes=axes)

    back = tetwarp.volume_from(image, axes=axes)
    assert np.array_equal(back.array, turned.array)
    assert np.allclose(back.affine, turned.affine)
    here = image.get_fdata()[4, 1, 2].squeeze()
    if turned.shape[3:] == (6,):  # NIfTI has the rows below the diagonal
        here = here[[0, 2, 5, 1, 4, 3]]
    assert np.array_equal(here, turned.array[2, 1, 4])
    place = image.affine @ (4, 1, 2, 1)
    signs = (1, 1, 1, 1) if axes == "RAS" else (-1, -1, 1, 1)
    assert np.allclose(place * signs, turned.affine @ (4, 1, 2, 1))


@pytest.mark.parametrize("axes", ["RAS", "LPS"])
def test_sitk_there_and_back(turned, axes):
    pytest.importorskip("SimpleITK")

    image = tetwarp.to_sitk(turned, axes=axes)

    back = tetwarp.volume_from(image, axes=axes)
    assert np.array_equal(back.array, turned.array)
    assert np.allclose(back.affine, turned.affine)
    assert np.array_equal(image[4, 1, 2], turned.array[2, 1, 4])
    place = np.append(image.TransformIndexToPhysicalPoint((4, 1, 2)), 1)
    signs = (1, 1, 1, 1) if axes == "LPS" else (-1, -1, 1, 1)
    assert np.allclose(place * signs, turned.affine @ (4, 1, 2, 1))


@pytest.mark.parametrize("axes", ["RAS", "LPS"])
def test_sitk_resamples_by_the_field_as_the_warp(volume, mesh, twisted, axes):
    sitk = pytest.importorskip("SimpleITK")
    field = tetwarp.displacement_field(*mesh, twisted, reference=volume)
    transform = tetwarp.to_sitk_transform(field, axes=axes)
    image = tetwarp.to_sitk(volume, axes=axes)

    resampled = sitk.GetArrayFromImage(sitk.Resample(image, image, transform, sitk.sitkLinear))

    warped = tetwarp.warp(volume, *mesh, twisted, interpolator="linear").volume
    inside = field.mask & (resampled != 0) & (warped != 0)
    assert inside.mean() > 0.2
    assert np.abs(resampled - warped)[inside].max() < 1e-3 * np.abs(warped).max()


def test_pyvista_gets_images_and_meshes(turned, mesh, twisted):
    pytest.importorskip("pyvista")

    image = tetwarp.to_pyvista(turned)
    grid = tetwarp.to_pyvista(mesh, twisted)

    assert image.dimensions == (5, 4, 3) and image.n_points == 60
    assert np.allclose(image.points[0], turned.grid.origin)
    assert np.array_equal(image.point_data["values"][1], turned.array[0, 0, 1])
    back = tetwarp.mesh_from(grid)
    assert np.allclose(back.points, twisted) and np.array_equal(back.cells, mesh.cells)


@pytest.mark.parametrize("hexahedra", [False, True])
@pytest.mark.parametrize("ending, needs", [("inp", "meshio"), ("bdf", "meshio"), ("nas", "meshio"),
                                           ("xdmf", "h5py"), ("e", "netCDF4"), ("vtu", "meshio")])
def test_files_of_finite_element_programs_come_and_go_by_meshio(
        ending, needs, hexahedra, volume, tmp_path):
    """Abaqus, Nastran, XDMF, Exodus and VTK; Nastran's numbers have 16 characters."""
    meshio = pytest.importorskip("meshio")
    pytest.importorskip(needs)
    mesh = tetwarp.lattice_mesh(volume, cells=3, hexahedra=hexahedra)

    meshio.write(tmp_path / f"mesh.{ending}", tetwarp.to_meshio(mesh))

    back = tetwarp.mesh_from(meshio.read(tmp_path / f"mesh.{ending}"))
    assert np.allclose(back.points, mesh.points, rtol=1e-7, atol=1e-9)
    assert np.array_equal(back.cells, mesh.cells)


def test_wrong_arguments_are_named(turned, monkeypatch):
    with pytest.raises(ValueError, match="image: expected an image of nibabel or SimpleITK"):
        tetwarp.volume_from(np.zeros(3), axes="RAS")
    monkeypatch.setitem(sys.modules, "meshio", None)
    with pytest.raises(ImportError, match="to_meshio: expected meshio; python3 -m pip install"):
        tetwarp.to_meshio((np.eye(4, 3), [[0, 1, 2, 3]]))
    monkeypatch.setitem(sys.modules, "SimpleITK", type(sys)("SimpleITK"))
    with pytest.raises(ValueError, match="axes: expected 'RAS' or 'LPS', got 'LAS'"):
        tetwarp.to_sitk(turned, axes="LAS")


def test_other_cells_are_no_mesh():
    blocks = {"triangle": np.array([(0, 1, 2)]), "wedge": np.array([(0, 1, 2, 3, 4, 5)])}
    other = type("Mesh", (), {"points": np.zeros((6, 3)), "cells_dict": blocks})

    with pytest.raises(ValueError, match="mesh: expected tetrahedra of four or ten.* found cells of wedge"):
        tetwarp.mesh_from(other)


def test_other_things_than_images_and_volumes_are_named(volume, mesh):
    nibabel = pytest.importorskip("nibabel")
    sitk = pytest.importorskip("SimpleITK")
    flat = nibabel.Nifti1Image(np.zeros((4, 5), np.float32), np.eye(4))
    slices = sitk.Image([4, 5], sitk.sitkFloat32)

    for image in (flat, slices):
        with pytest.raises(ValueError, match="image: expected an image of three"):
            tetwarp.volume_from(image, axes="RAS")
        with pytest.raises(ValueError, match="reference: expected an image of three"):
            tetwarp.warp(volume, *mesh, mesh.points, reference=image)
        with pytest.raises(ValueError, match="volume: expected samples, got an image; tetwarp.volu"):
            tetwarp.lattice_mesh(image)
    for call in (tetwarp.to_nibabel, tetwarp.to_sitk):
        with pytest.raises(ValueError, match="volume: expected a Volume, got ndarray"):
            call(volume.array, axes="RAS")
    with pytest.raises(ValueError, match="field: expected a Field, got Volume"):
        tetwarp.to_sitk_transform(volume, axes="RAS")


def test_numbers_of_nodes_are_not_cut():
    cells = {"tetra": np.array([(0, 1, 2, 2**32 + 3)])}
    with pytest.raises(ValueError, match="mesh: expected numbers of nodes from 0 to 3, found"):
        tetwarp.mesh_from(types.SimpleNamespace(points=np.eye(4, 3), cells_dict=cells))


@pytest.mark.parametrize("order", "CF")
def test_images_of_nibabel_are_copied_and_go_by_files(turned, order, tmp_path):
    """What to_nibabel saves is what write writes, and reading either way gives the volume."""
    nibabel = pytest.importorskip("nibabel")
    image = tetwarp.to_nibabel(turned, axes="RAS")
    nibabel.save(image, tmp_path / "theirs.nii")
    tetwarp.write(tmp_path / "ours.nii", turned)

    read = tetwarp.read(tmp_path / "theirs.nii")
    back = tetwarp.volume_from(nibabel.load(tmp_path / "ours.nii"), axes="RAS")

    assert np.array_equal(read.array, turned.array) and np.array_equal(back.array, turned.array)
    ours = tetwarp.read(tmp_path / "ours.nii").nifti
    assert read.nifti["intent_code"] == ours["intent_code"]
    assert np.array_equal(read.nifti["intent_p"], ours["intent_p"])
    data = np.array(image.dataobj, order=order)
    copy = tetwarp.volume_from(nibabel.Nifti1Image(data, np.eye(4), image.header), axes="RAS")
    assert not np.shares_memory(copy.array, data)
    assert np.array_equal(copy.array, turned.array)


@pytest.mark.parametrize("shape", [(4, 3, 2, 2), (4, 3, 2, 5), (4, 3, 2, 2, 3), (4, 3, 2, 1, 3, 2)])
def test_several_times_of_nibabel_are_refused(shape):
    nibabel = pytest.importorskip("nibabel")
    image = nibabel.Nifti1Image(np.zeros(shape, np.float32), np.eye(4))

    with pytest.raises(ValueError, match="image: expected one time"):
        tetwarp.volume_from(image, axes="RAS")
    if len(shape) == 4:
        one = tetwarp.volume_from(image.slicer[:, :, :, 1:2], axes="RAS")
        assert one.shape == (2, 3, 4)


@pytest.mark.parametrize("kind, count", [("tetra", 4), ("tetra10", 10), ("hexahedron", 8)])
@pytest.mark.parametrize("dtype", ["f8", "?", "c16", "i2", "u8"])
def test_numbers_of_nodes_are_integers(kind, count, dtype):
    cells = np.arange(count)[None].astype(dtype)
    mesh = types.SimpleNamespace(points=np.random.default_rng(2).random((count, 3)),
                                 cells_dict={kind: cells})

    if cells.dtype.kind in "iu":
        assert tetwarp.mesh_from(mesh).cells.tolist() == [list(range(count))]
        return
    with pytest.raises(ValueError, match="mesh: expected integers"):
        tetwarp.mesh_from(mesh)
