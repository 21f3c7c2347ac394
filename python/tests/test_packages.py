"""Files that tetwarp-read was built without a library for are read by packages of Python. Errors of
such a build are raised in place of the calls that read."""

import sys

import numpy as np
import pytest

import tetwarp


@pytest.fixture
def lacking(monkeypatch):
    """As a wheel: no VTK, no GDCM."""
    def refuse(path, *_):
        error = tetwarp._core.MissingLibrary(f"{path}: this build cannot read it")
        error.library = "GDCM" if str(path).endswith(".dcm") else "VTK"
        raise error

    for name in ("MeshFile", "read_surface", "kind_of"):
        monkeypatch.setattr(tetwarp._core, name, refuse)


def test_meshes_and_surfaces_are_read_by_meshio(mesh, twisted, tmp_path, lacking):
    meshio = pytest.importorskip("meshio")
    written = tetwarp.to_meshio(mesh)
    written.point_data = {"displacement": twisted - mesh.points, "heat": mesh.points[:, 0]}
    written.write(tmp_path / "mesh.vtu")
    points, faces = tetwarp.boundary_surface(*mesh)
    meshio.Mesh(points, [("triangle", faces)]).write(tmp_path / "surface.ply")

    file = tetwarp.read(tmp_path / "mesh.vtu")
    turned = tetwarp.MeshFile(tmp_path / "mesh.vtu", axes="lps")
    surface = tetwarp.read(tmp_path / "surface.ply")

    assert np.array_equal(file.mesh.points, mesh.points)
    assert np.array_equal(file.mesh.cells, mesh.cells)
    assert len(file) == 1 and np.allclose(file.step(0), twisted, rtol=0, atol=1e-12)
    assert file.not_read == ["heat"]
    assert np.array_equal(turned.step(0), file.step(0) * (-1, -1, 1))
    assert np.array_equal(surface.points, points) and np.array_equal(surface.triangles, faces)


def test_images_are_read_by_vtk(tmp_path, lacking):
    vtk = pytest.importorskip("vtk")
    from vtkmodules.util.numpy_support import numpy_to_vtk

    samples = np.arange(2 * 3 * 4 * 2, dtype=np.int16).reshape(2, 3, 4, 2)
    turn = [(0.8, -0.6, 0), (0.6, 0.8, 0), (0, 0, 1)]
    image = vtk.vtkImageData()
    image.SetExtent(5, 8, 6, 8, 7, 8)
    image.SetSpacing(1, 2, 3)
    image.SetOrigin(10, 20, 30)
    image.SetDirectionMatrix(np.ravel(turn))
    array = numpy_to_vtk(samples.reshape(-1, 2), deep=True)
    array.SetName("pairs")
    image.GetPointData().AddArray(array)
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(str(tmp_path / "image.vti"))
    writer.SetInputData(image)
    writer.Write()

    for name in ("", "pairs"):
        volume = tetwarp.read(tmp_path / "image.vti", array=name)
        assert np.array_equal(volume.array, samples) and volume.name == "pairs"
        first = np.array((10, 20, 30)) + np.array(turn) @ (5, 12, 21)
        assert np.allclose(volume.grid.points()[0, 0, 0], first)
        assert np.allclose(volume.affine[:3, :3], np.array(turn) * (1, 2, 3))
    with pytest.raises(tetwarp.IoError, match="VTK finds no array triples"):
        tetwarp.read(tmp_path / "image.vti", array="triples")


@pytest.mark.parametrize("name, module, pip", [
    ("a.vtu", "meshio", "meshio"), ("a.ply", "meshio", "meshio"),
    ("a.vti", "vtkmodules.vtkIOXML", "vtk"), ("a.dcm", "pydicom", "pydicom")])
def test_the_package_that_is_missing_is_named(name, module, pip, tmp_path, lacking, monkeypatch):
    monkeypatch.setitem(sys.modules, module, None)
    (tmp_path / name).touch()

    text = f"{name}: this build .*; in Python: python3 -m pip install {pip}$"
    with pytest.raises(tetwarp.IoError, match=text):
        tetwarp.read(tmp_path / name)


def test_the_library_that_a_reader_lacks_arrives(tmp_path, monkeypatch):
    """A program in place of tetwarp-read answers as one that was built without the library."""
    reader = tmp_path / "reader"
    reader.write_text(f"""#!{sys.executable} -S
import struct, sys
texts = b"VTK", b"this build cannot read it"
sys.stdout.buffer.write(b"\\2" + b"".join(struct.pack("<Q", len(t)) + t for t in texts))
""")
    reader.chmod(0o755)
    monkeypatch.setenv("TETWARP_READER", str(reader))
    for module in ("meshio", "vtkmodules.vtkIOXML"):
        monkeypatch.setitem(sys.modules, module, None)
    for name, kind in (("a.vtu", "UnstructuredGrid"), ("a.vti", "ImageData")):
        (tmp_path / name).write_text(f'<VTKFile type="{kind}">')

        with pytest.raises(tetwarp.IoError, match=f"{name}: this build cannot read it; in Python: "):
            tetwarp.read(tmp_path / name)
    with pytest.raises(tetwarp._core.MissingLibrary) as caught:
        tetwarp._core.MeshFile(str(tmp_path / "a.vtu"), 0, "ras", True)
    assert caught.value.library == "VTK" and isinstance(caught.value, OSError)


def test_damaged_files_are_named(tmp_path, lacking):
    meshio = pytest.importorskip("meshio")
    (tmp_path / "mesh.vtu").write_text("<VTKFile/>")
    meshio.Mesh(np.eye(3), [("line", [(0, 1)])]).write(tmp_path / "lines.vtk")

    for name in ("mesh.vtu", "lines.vtk"):
        with pytest.raises(tetwarp.IoError, match=name):
            tetwarp.read(tmp_path / name)


def test_other_errors_stay_as_they_are(tmp_path):
    with pytest.raises(tetwarp.IoError) as caught:
        tetwarp.read(tmp_path / "none.vtu")

    assert "meshio" not in str(caught.value)


def _touching(random):
    """Tetrahedra that touch in points, edges and faces of a coarse grid, each with points of its own
    or with shared ones, among points of none."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
    faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    points, triangles = [random.random((2, 3))], []
    for _ in range(6):
        start = sum(map(len, points))
        points.append((corners + random.integers(0, 2, 3)) * random.choice((-1.0, 1), 3))
        triangles.append(random.permutation(faces)[:random.integers(1, 5)] + start)
    points, triangles = np.vstack(points), np.vstack(triangles)
    if random.random() < 0.5:  # the first three pieces in common
        _, first, place = np.unique(points[:14], axis=0, return_index=True, return_inverse=True)
        triangles = np.append(first[place.reshape(-1)], np.arange(14, len(points)))[triangles]
    return points, triangles.astype(np.int32)


@pytest.mark.parametrize("ending", ["ply", "obj", "stl"])
@pytest.mark.parametrize("seed", range(5))
def test_surfaces_by_meshio_are_those_of_tetwarp_read(ending, seed, tmp_path):
    meshio = pytest.importorskip("meshio")
    points, triangles = _touching(np.random.default_rng(seed))
    path = tmp_path / f"a.{ending}"
    meshio.Mesh(points, [("triangle", triangles)]).write(path)
    try:
        expected = tetwarp.read(path)
    except tetwarp._core.MissingLibrary:
        pytest.skip("tetwarp-read has no VTK")

    read = tetwarp._packages.read_surface(str(path), OSError("no VTK"))

    assert np.array_equal(read.points, expected.points)
    assert np.array_equal(read.triangles, expected.triangles)


@pytest.mark.parametrize("hexahedra", [False, True])
@pytest.mark.parametrize("seed", range(2))
def test_meshes_by_meshio_are_those_of_tetwarp_read(hexahedra, seed, tmp_path):
    """Of cells that are there twice, with the same nodes or with others at their places, one stays."""
    meshio = pytest.importorskip("meshio")
    random = np.random.default_rng(seed)
    points, cells = tetwarp.lattice_mesh(np.ones((4, 4, 4)), cells=2, hexahedra=hexahedra)
    again = random.choice(len(cells), 5)
    both = np.vstack([cells, cells[again], cells[again] + len(points)])
    both = both[random.permutation(len(both))]
    kind = "hexahedron" if hexahedra else "tetra"
    path = tmp_path / "a.vtu"
    meshio.Mesh(np.vstack([points, points]), [(kind, both)]).write(path)
    try:
        expected = tetwarp.MeshFile(path)
    except tetwarp._core.MissingLibrary:
        pytest.skip("tetwarp-read has no VTK")

    read = tetwarp._packages.MeshioFile(str(path), 0, "ras", OSError("no VTK"))

    tets, hexes = read.mesh()[1:3]
    assert np.array_equal(read.mesh()[0], expected.mesh.points)
    assert np.array_equal(hexes if hexahedra else tets, expected.mesh.cells)
    assert expected.mesh.cell_count == len(cells)
