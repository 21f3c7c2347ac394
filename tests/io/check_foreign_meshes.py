"""Compares meshes of multi-block files (.vtm) and of Exodus with VTK, which writes them here.

Usage: check_foreign_meshes.py COMMAND

A box of hexahedra, wedges and tetrahedra is divided into blocks, in Exodus with steps, and moved by a
displacement that differs from node to node and step to step. What `import` makes of each file is compared
with what was written: positions of nodes, nodes of cells, times and displacements. Exits 77 when VTK or h5py is
missing, 1 when something differs.
"""
import os
import subprocess
import sys
import tempfile

try:
    import h5py
    import numpy as np
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import (VTK_HEXAHEDRON, VTK_TETRA, VTK_TRIANGLE, VTK_WEDGE,
                                               vtkMultiBlockDataSet, vtkPolyData,
                                               vtkUnstructuredGrid)
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOExodus import vtkExodusIIWriter
    from vtkmodules.vtkIOXML import vtkXMLMultiBlockDataWriter
except ImportError as error:
    print(f"skipped: {error}; the packages are python3-vtk9 and python3-h5py")
    sys.exit(77)

TIMES = [0.0, 0.25, 1.5]
KINDS = (VTK_TETRA, VTK_HEXAHEDRON, VTK_WEDGE)
# Cubes of a row: a hexahedron, two wedges, five tetrahedra; nodes by their place in the cube (x fastest).
CELLS = [(0, VTK_HEXAHEDRON, (0, 1, 3, 2, 4, 5, 7, 6)), (1, VTK_WEDGE, (0, 1, 3, 4, 5, 7)),
         (1, VTK_WEDGE, (0, 3, 2, 4, 7, 6)), (2, VTK_TETRA, (0, 3, 5, 6)), (2, VTK_TETRA, (1, 3, 0, 5)),
         (2, VTK_TETRA, (2, 0, 3, 6)), (2, VTK_TETRA, (4, 5, 0, 6)), (2, VTK_TETRA, (7, 3, 6, 5))]


def box():
    """Positions of the nodes of three cubes in a row, and type and nodes of each cell."""
    points = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in range(4)], float)
    points += 0.1 * np.sin(7 * points[:, ::-1] + 1)
    node = lambda cube, n: cube + n % 2 + 4 * (n // 2)
    return points, [(kind, [node(cube, n) for n in nodes]) for cube, kind, nodes in CELLS]


def displacement(points, step):
    return 0.01 * (step + 1) * np.cos(5 * points[:, [2, 0, 1]] + step)


def grid_of(points, cells, name, step):
    """A grid of VTK with the nodes of `points` that its cells have, and the numbers of these nodes."""
    used = sorted({n for _, nodes in cells for n in nodes})
    place = {n: p for p, n in enumerate(used)}
    grid, where = vtkUnstructuredGrid(), vtkPoints()
    where.SetDataTypeToDouble()
    for n in used:
        where.InsertNextPoint(points[n])
    grid.SetPoints(where)
    for kind, nodes in cells:
        grid.InsertNextCell(kind, len(nodes), [place[n] for n in nodes])
    array = numpy_to_vtk(displacement(points[used], step), deep=True)
    array.SetName(name)
    grid.GetPointData().AddArray(array)
    return grid, used


class Expected:
    """What import has to make of parts, each with its cells and the numbers of its nodes."""

    def __init__(self, points, parts):
        self.nodes, self.tets, self.hexes = [], [], []
        for cells, used in parts:
            place = {n: len(self.nodes) + p for p, n in enumerate(used)}
            self.nodes += used
            for kind, nodes in cells:
                numbers = [place[n] for n in nodes]
                if kind == VTK_TETRA:
                    self.tets.append(numbers)
                elif kind == VTK_WEDGE:
                    self.hexes.append([numbers[n] for n in (0, 1, 2, 2, 3, 4, 5, 5)])
                else:
                    self.hexes.append(numbers)
        self.points = points[self.nodes]

    def compare(self, what, path, times):
        with h5py.File(path) as file:
            group = file["VTKHDF"]
            count = len(self.points)
            equal(f"{what}: nodes", group["Points"][:count], self.points)
            ends = group["Offsets"][()]
            cells = [group["Connectivity"][a:b].tolist() for a, b in zip(ends, ends[1:])]
            equal(f"{what}: cells", sum(cells, []), sum(self.tets + self.hexes, []))
            found = group["PointData/displacement"][()].reshape(len(times), count, 3)
            equal(f"{what}: displacements", found,
                  [displacement(self.points, step) for step in range(len(times))])
            if "Steps" in group:
                equal(f"{what}: times", group["Steps/Values"][()], times)
            else:
                equal(f"{what}: steps", len(times), 1)


def equal(what, found, expected):
    if np.shape(found) != np.shape(expected) or not np.array_equal(found, expected):
        sys.exit(f"{what}: {found}, expected {expected}")


class Steps(VTKPythonAlgorithmBase):
    """A source of data at times, which the writer needs for displacements."""

    def __init__(self, data_at, times):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType=data_at(0).GetClassName())
        self.data_at, self.times = data_at, times

    def RequestInformation(self, request, inputs, outputs):
        facts = outputs.GetInformationObject(0)
        facts.Set(vtkStreamingDemandDrivenPipeline.TIME_STEPS(), self.times, len(self.times))
        facts.Set(vtkStreamingDemandDrivenPipeline.TIME_RANGE(), [self.times[0], self.times[-1]], 2)
        return 1

    def RequestData(self, request, inputs, outputs):
        time = outputs.GetInformationObject(0).Get(
            vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP())
        data = self.data_at(self.times.index(time) if time in self.times else 0)
        output = type(data).GetData(outputs)
        output.ShallowCopy(data)
        output.GetInformation().Set(output.DATA_TIME_STEP(), time or 0.0)
        return 1


def write_exodus(path, data_at, times):
    writer = vtkExodusIIWriter()
    source = Steps(data_at, times)
    writer.SetInputConnection(source.GetOutputPort())
    writer.SetFileName(path)
    writer.WriteAllTimeStepsOn()
    writer.Write()


def in_blocks(grids, name="part"):
    blocks = vtkMultiBlockDataSet()
    for b, grid in enumerate(grids):
        blocks.SetBlock(b, grid)
        blocks.GetMetaData(b).Set(vtkMultiBlockDataSet.NAME(), f"{name} {b}")
    return blocks


def write_blocks(path, data):
    writer = vtkXMLMultiBlockDataWriter()
    writer.SetInputData(data)
    writer.SetFileName(path)
    writer.Write()


def surface_of(points):
    grid, where = vtkPolyData(), vtkPoints()
    for n in range(3):
        where.InsertNextPoint(points[n])
    grid.SetPoints(where)
    grid.Allocate(1)
    grid.InsertNextCell(VTK_TRIANGLE, 3, [0, 1, 2])
    return grid


def main(command):
    points, cells = box()
    by_kind = [[cell for cell in cells if cell[0] == kind] for kind in KINDS]
    sorted_cells = sum(by_kind, [])
    parts = [(block, grid_of(points, block, "u", 0)[1]) for block in by_kind]
    whole = Expected(points, [(sorted_cells, list(range(len(points))))])
    apart = Expected(points, parts)
    command = os.path.abspath(command)
    with tempfile.TemporaryDirectory() as folder:

        def check(expected, name, times, *words, left_out=""):
            path = os.path.join(folder, "out.vtkhdf")
            result = subprocess.run([command, "import", os.path.join(folder, name), "-o", path, *words],
                                    capture_output=True, text=True, check=False)
            if result.returncode != 0 or left_out not in result.stderr:
                sys.exit(f"{name}: {result.stderr}")
            expected.compare(name, path, times)

        path = lambda name: os.path.join(folder, name)
        for name, times, words in (("displacement", TIMES, ()), ("DISPL", TIMES[:1], ()),
                                   ("u", TIMES, ("--displacement", "u"))):
            # Blocks of one grid have the nodes of the file; those of a multi-block set their own ones.
            write_exodus(path("whole.exo"), lambda step: grid_of(points, sorted_cells, name, step)[0],
                         times)
            check(whole, "whole.exo", times, *words)
        write_exodus(path("apart.e"), lambda step: in_blocks(
            [grid_of(points, block, "displacement", step)[0] for block in by_kind]), TIMES)
        check(apart, "apart.e", TIMES)
        for step in range(len(TIMES)):
            grids = [grid_of(points, block, "displacement", step)[0] for block in by_kind]
            nested = in_blocks([grids[0], in_blocks(grids[1:], "inner"), surface_of(points)])
            write_blocks(path(f"step_{step}.vtm"), nested)
        check(apart, "step_0.vtm", TIMES[:1], left_out="1 blocks that are no unstructured grids")
        check(apart, "step_*.vtm", range(len(TIMES)))
        with open(path("all.pvd"), "w", encoding="ascii") as file:
            file.write("<VTKFile type='Collection'><Collection>" + "".join(
                f"<DataSet timestep='{time}' file='step_{step}.vtm'/>"
                for step, time in enumerate(TIMES)) + "</Collection></VTKFile>")
        check(apart, "all.pvd", TIMES)
    print("Exodus with shared and separate nodes, .vtm, lists of them: nodes, cells, steps, displacements")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
