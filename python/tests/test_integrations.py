"""The example module of 3D Slicer and the example controller of SOFA. Stand-ins take the place of SOFA
and of Slicer's panel; nodes, scene and grid transform are those of Slicer where its libraries are
installed (slicer-core of PyPI), and stand-ins elsewhere. VTK is real."""

import importlib.util
import sys
import types
from pathlib import Path

import numpy as np
import pytest

import tetwarp

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
TURN = np.array([(0, -1, 0), (1, 0, 0), (0, 0, 1.0)])


def load(path):
    if not path.exists():
        pytest.skip("no folder examples beside the tests")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def fill():
    pytest.importorskip("vtk")
    return load(EXAMPLES / "slicer" / "TetWarp" / "TetWarpLib" / "fill.py")


@pytest.fixture
def scan():
    """A torso on a turned grid, a mesh that leaves its border uncovered, and its bend."""
    plain = tetwarp.phantom(shape=(12, 14, 18))
    grid = tetwarp.Grid(plain.shape, (4.0, 5, 6), (10, -20, 30), TURN)
    volume = tetwarp.Volume(plain.array, grid)
    mesh = tetwarp.lattice_mesh(volume, cells=4, threshold=0.3)
    return volume, mesh, tetwarp.deform(*mesh, kind="bend", amount=0.2)


def vtk_image(volume):
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    image = vtkImageData()
    image.SetDimensions(*reversed(volume.shape))
    image.GetPointData().SetScalars(numpy_to_vtk(volume.array.reshape(-1), deep=True))
    return image


def vtk_mesh(points, cells):
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import (
        VTK_HEXAHEDRON, VTK_TETRA, VTK_VERTEX, vtkCellArray, vtkUnstructuredGrid)

    grid, places, array = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
    places.SetData(numpy_to_vtk(np.array(points), deep=True))
    grid.SetPoints(places)
    width = cells.shape[1]
    offsets = np.append(0, 1 + width * np.arange(len(cells) + 1))
    array.SetData(numpy_to_vtkIdTypeArray(offsets, True),
                  numpy_to_vtkIdTypeArray(np.append(0, cells.ravel()).astype(np.int64), True))
    kind = VTK_TETRA if width == 4 else VTK_HEXAHEDRON
    grid.SetCells([VTK_VERTEX] + [kind] * len(cells), array)
    return grid


def stand_in_grid_transform():
    """Slicer's vtkOrientedGridTransform: VTK's grid transform, on axes that are turned."""
    from vtkmodules.vtkFiltersHybrid import vtkGridTransform

    class StandInOrientedGridTransform(vtkGridTransform):
        def SetGridDirectionMatrix(self, matrix):
            self.directions = np.array([[matrix.GetElement(r, c) for c in range(3)]
                                        for r in range(3)])

        def place_of(self, position):
            """Where a position goes: the grid is asked in its own axes."""
            turned = self.directions.T @ position
            origin = np.array(self.GetDisplacementGrid().GetOrigin())
            local = origin + turned - self.directions.T @ origin
            return position + np.array(self.TransformPoint(local)) - local

    return StandInOrientedGridTransform()


def test_images_of_vtk_are_filled_as_arrays_are(fill, scan):
    from vtkmodules.vtkCommonDataModel import vtkImageData

    volume, mesh, bent = scan
    output = vtkImageData()

    for options in (dict(outside="falloff", falloff=30), dict(interpolator="nearest")):
        fill.fill_image(output, vtk_image(volume), volume.affine, vtk_mesh(*mesh), bent, **options)

        expected = tetwarp.warp(volume, *mesh, bent, **options)
        assert np.array_equal(fill.samples_of(output), expected.volume)
    first = fill.samples_of(output)
    fill.fill_image(output, vtk_image(volume), volume.affine, vtk_mesh(*mesh), bent)
    assert np.shares_memory(first, fill.samples_of(output))  # written in place


def test_meshes_of_vtk_are_read(fill, scan):
    from vtkmodules.vtkCommonCore import vtkIdList

    volume, mesh, _ = scan
    hexes = tetwarp.lattice_mesh(volume, cells=3, hexahedra=True)

    for points, cells in (mesh, hexes):
        read_points, read_cells = fill.mesh_of(vtk_mesh(points, cells))
        assert np.array_equal(read_points, points) and np.array_equal(read_cells, cells)
    with_flat = vtk_mesh(*mesh)
    for kind, count in {1: 1, 3: 2, 5: 3, 7: 5, 9: 4, 21: 3, 22: 6, 23: 8, 28: 9, 68: 3}.items():
        ids = vtkIdList()
        for node in range(count):
            ids.InsertNextId(node)
        with_flat.InsertNextCell(kind, ids)  # points, edges, faces, also curved ones: left out
    assert np.array_equal(fill.mesh_of(with_flat)[1], mesh.cells)
    wrong = vtk_mesh(*mesh)
    fill.WrapDataObject(wrong).CellTypes[1] = 14  # a pyramid
    with pytest.raises(ValueError, match=r"found cells of VTK's types \[10, 14\]"):
        fill.mesh_of(wrong)


def test_a_grid_transform_has_the_displacements_of_all_voxels(fill, scan):
    volume, mesh, bent = scan
    transform = stand_in_grid_transform()

    field = fill.fill_grid_transform(transform, tuple(reversed(volume.shape)), volume.affine,
                                     vtk_mesh(*mesh), bent, outside="falloff", falloff=30)
    assert np.shares_memory(fill.samples_of(transform.GetDisplacementGrid()), field.values)
    del field  # VTK keeps its memory

    centers = volume.grid.points().reshape(-1, 3)
    places = np.array([transform.place_of(center) for center in centers])
    inside = tetwarp.transform_points(centers, *mesh, bent, inverse=True, reference=volume)
    covered = ~np.isnan(inside[:, 0])
    assert 0.2 < covered.mean() < 0.9
    assert np.abs(places - inside)[covered].max() < 1e-4  # float32 displacements of some 50 mm
    moved = np.linalg.norm(places - centers, axis=1)
    assert (moved[~covered] > 0.1).mean() > 0.1  # outside included, not zero at the border
    assert moved[~covered].max() <= np.linalg.norm(bent - mesh.points, axis=1).max() + 1e-3


class StandInNode:
    """A volume, model or grid transform node of Slicer."""

    def __init__(self, image=None, affine=None, mesh=None):
        self.image, self.affine, self.mesh = image, affine, mesh
        self.is_shown = False

    def GetDisplayNode(self):
        return self if self.is_shown else None

    def CreateDefaultDisplayNodes(self):
        self.is_shown = True

    def GetImageData(self):
        return self.image

    def SetAndObserveImageData(self, image):
        self.image = image

    def GetMesh(self):
        return self.mesh

    def GetIJKToRASMatrix(self, matrix):
        for row in range(4):
            for column in range(4):
                matrix.SetElement(row, column, self.affine[row, column])

    def SetIJKToRASMatrix(self, matrix):
        self.affine = stand_in_array(matrix)

    def SetAndObserveTransformFromParent(self, transform):
        self.transform = transform


def matrix_of(array):
    from vtkmodules.vtkCommonMath import vtkMatrix4x4

    matrix = vtkMatrix4x4()
    for row, column in np.ndindex(4, 4):
        matrix.SetElement(row, column, array[row, column])
    return matrix


def stand_in_array(matrix):
    return np.array([[matrix.GetElement(r, c) for c in range(4)] for r in range(4)])


@pytest.fixture
def panel(monkeypatch):
    """Names that the module uses beside nodes: its classes and Qt."""
    modules = {name: types.ModuleType(name) for name in ("slicer.ScriptedLoadableModule", "qt")}
    for base in ("", "Logic", "Widget"):
        name = "ScriptedLoadableModule" + base
        setattr(modules["slicer.ScriptedLoadableModule"], name, type(name, (), {}))
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.syspath_prepend(EXAMPLES / "slicer" / "TetWarp")


@pytest.fixture
def slicer(panel, monkeypatch):
    """Names of Slicer's libraries that the module uses."""
    module = types.ModuleType("slicer")
    module.util = types.SimpleNamespace(arrayFromVTKMatrix=stand_in_array)
    module.vtkOrientedGridTransform = stand_in_grid_transform
    monkeypatch.setitem(sys.modules, "slicer", module)


def test_the_logic_of_the_slicer_module_fills_its_nodes(slicer, scan):
    pytest.importorskip("vtk")
    volume, mesh, bent = scan
    module = load(EXAMPLES / "slicer" / "TetWarp" / "TetWarp.py")
    source = StandInNode(vtk_image(volume), volume.affine)
    output, transform = StandInNode(), StandInNode()

    result, field = module.TetWarpLogic().process(
        source, StandInNode(mesh=vtk_mesh(*mesh)), StandInNode(mesh=vtk_mesh(bent, mesh.cells)),
        output, transform, outside="nearest")

    expected = tetwarp.warp(volume, *mesh, bent, outside="nearest")
    assert np.array_equal(result.volume, expected.volume)
    assert np.allclose(output.affine, volume.affine) and output.is_shown
    assert output.GetImageData().GetDimensions() == tuple(reversed(volume.shape))
    assert transform.transform.GetDisplacementGrid().GetNumberOfPoints() == volume.array.size
    assert field.values.shape == (*volume.shape, 3)


def test_nodes_of_slicer_follow_the_mesh(panel, scan):
    """Nodes, scene and grid transform of Slicer's own libraries."""
    pytest.importorskip("slicer_core")
    import slicer

    volume, mesh, bent = scan
    matrix = matrix_of(volume.affine)
    nodes = [slicer.vtkMRMLScalarVolumeNode() for _ in range(3)]
    source, output, hardened = nodes
    rest, deformed = slicer.vtkMRMLModelNode(), slicer.vtkMRMLModelNode()
    transform = slicer.vtkMRMLGridTransformNode()
    scene = slicer.vtkMRMLScene()
    for node in (*nodes, rest, deformed, transform):
        scene.AddNode(node)
    for node in (source, hardened):
        node.SetAndObserveImageData(vtk_image(volume))
        node.SetIJKToRASMatrix(matrix)
    rest.SetAndObserveMesh(vtk_mesh(*mesh))
    deformed.SetAndObserveMesh(vtk_mesh(bent, mesh.cells))
    module = load(EXAMPLES / "slicer" / "TetWarp" / "TetWarp.py")

    result, field = module.TetWarpLogic().process(
        source, rest, deformed, output, transform, outside="nearest")

    assert np.array_equal(slicer.util.arrayFromVolume(output), result.volume)
    assert output.GetDisplayNode() is not None
    centers = volume.grid.points().reshape(-1, 3)
    from_parent = transform.GetTransformFromParent()
    places = np.array([from_parent.TransformPoint(center) for center in centers])
    assert np.abs(places - centers - field.values.reshape(-1, 3)).max() < 1e-9
    inside = tetwarp.transform_points(centers, *mesh, bent, inverse=True, reference=volume)
    covered = ~np.isnan(inside[:, 0])
    assert np.abs(places - inside)[covered].max() < 1e-4
    # A volume that is hardened under the transform is the warped one, on the grid that Slicer makes.
    hardened.SetAndObserveTransformNodeID(transform.GetID())
    assert hardened.HardenTransform()
    hardened.GetIJKToRASMatrix(matrix)
    samples = slicer.util.arrayFromVolume(hardened)
    grid = tetwarp.Grid.from_affine(samples.shape, stand_in_array(matrix))
    expected = tetwarp.warp(volume, *mesh, bent, reference=grid, outputs="mask")
    covered = expected.mask > 0
    error = np.abs(samples - expected.volume)[covered]
    assert covered.mean() > 0.5 and error.mean() < 0.01 * np.ptp(volume.array), error.mean()


class StandInSofa:
    """Sofa.Core with a Controller that keeps its keywords."""

    class Controller:
        def __init__(self, **keywords):
            self.keywords = keywords


@pytest.fixture
def sofa(monkeypatch):
    package = types.ModuleType("Sofa")
    package.Core = StandInSofa
    monkeypatch.setitem(sys.modules, "Sofa", package)
    monkeypatch.setitem(sys.modules, "Sofa.Core", StandInSofa)


def test_a_volume_follows_a_scene_of_sofa(sofa, scan):
    example = load(EXAMPLES / "sofa" / "warp_beside_scene.py")
    volume, mesh, bent = scan
    calls = []
    state = types.SimpleNamespace(position=types.SimpleNamespace(value=mesh.points.copy()))
    follower = example.VolumeFollower(volume, *mesh, every=2,
                                      on_volume=lambda *call: calls.append(call))
    controller = example.make_controller(follower, state)
    samples = follower.samples

    for step in range(4):
        state.position.value[:] += 0.25 * (bent - mesh.points)  # as SOFA does, in place
        controller.onAnimateEndEvent(None)

    assert controller.keywords == {"name": "tetwarp"}
    assert [step for step, _ in calls] == [2, 4]
    assert all(array is samples for _, array in calls)
    assert np.array_equal(samples, tetwarp.warp(volume, *mesh, state.position.value).volume)
    with pytest.raises(ValueError, match="every: expected 1 or more"):
        example.VolumeFollower(volume, *mesh, every=0)


def test_the_scene_of_sofa_names_parts_that_belong_together(sofa):
    example = load(EXAMPLES / "sofa" / "warp_beside_scene.py")
    added = {}

    class Node:
        def addObject(self, kind, **keywords):
            added[kind if isinstance(kind, str) else "controller"] = keywords
            return types.SimpleNamespace(position=None)

        def addChild(self, name):
            return self

    example.createScene(Node())

    topology = added["TetrahedronSetTopologyContainer"]
    assert np.max(topology["tetrahedra"]) < len(topology["position"])
    assert len(added["FixedProjectiveConstraint"]["indices"]) > 3 and "controller" in added
