"""Fills images and grid transforms of VTK from a deformed mesh, at full resolution and beyond the
mesh. Needs VTK and tetwarp, nothing of Slicer.

Positions are in RAS, the world of Slicer. Matrices are 4 x 4 arrays, from voxels (i, j, k) to RAS.
"""

import numpy as np
import tetwarp
from vtkmodules.numpy_interface.dataset_adapter import WrapDataObject
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import (
    VTK_HEXAHEDRON,
    VTK_TETRA,
    vtkGenericCell,
    vtkImageData,
)
from vtkmodules.vtkCommonMath import vtkMatrix4x4


def dimensions_of(kind):
    """Of cells of a type of VTK; those of no known type count as solid."""
    cell = vtkGenericCell.InstantiateCell(kind)
    return 3 if cell is None else cell.GetCellDimension()


def mesh_of(grid):
    """Nodes and cells of a vtkUnstructuredGrid of tetrahedra or hexahedra; other cells of three
    dimensions are an error, cells of fewer are left out.
    """
    kinds = np.asarray(WrapDataObject(grid).CellTypes)
    cells = grid.GetCells()
    offsets = vtk_to_numpy(cells.GetOffsetsArray())
    corners = vtk_to_numpy(cells.GetConnectivityArray())
    solid = {kind for kind in np.unique(kinds).tolist() if dimensions_of(kind) == 3}
    if len(solid) != 1 or not solid <= {VTK_TETRA, VTK_HEXAHEDRON}:
        raise ValueError("expected a mesh of tetrahedra (VTK_TETRA) or of hexahedra, found cells "
                         f"of VTK's types {sorted(solid)}")
    kind = solid.pop()
    count = 4 if kind == VTK_TETRA else 8
    rows = offsets[:-1][kinds == kind]
    return points_of(grid), corners[rows[:, None] + np.arange(count)]


def points_of(grid):
    """Positions of the points of a vtkPointSet, (n, 3) float64."""
    return np.asarray(vtk_to_numpy(grid.GetPoints().GetData()), dtype=np.float64)


def samples_of(image):
    """Samples of a vtkImageData in place: (z, y, x) or (z, y, x, components)."""
    x, y, z = image.GetDimensions()
    scalars = image.GetPointData().GetScalars()
    components = scalars.GetNumberOfComponents()
    return vtk_to_numpy(scalars).reshape((z, y, x) + ((components,) if components > 1 else ()))


def fill_image(output, image, ijk_to_ras, grid, deformed, **options):
    """Warps an image into another one of the same size and type, whose samples are overwritten.

    output, image : vtkImageData; `output` may be new, then it gets its memory here
    grid : vtkUnstructuredGrid at rest
    deformed : (n, 3) positions of its points
    options : keywords of tetwarp.warp, such as interpolator, outside and falloff

    Returns tetwarp.WarpResult.
    """
    if (output.GetDimensions() != image.GetDimensions()
            or output.GetNumberOfScalarComponents() != image.GetNumberOfScalarComponents()
            or output.GetScalarType() != image.GetScalarType()
            or output.GetPointData().GetScalars() is None):
        output.SetDimensions(image.GetDimensions())
        output.AllocateScalars(image.GetScalarType(), image.GetNumberOfScalarComponents())
    result = tetwarp.warp(samples_of(image), *mesh_of(grid), deformed, affine=ijk_to_ras,
                          out=samples_of(output), **options)
    output.GetPointData().GetScalars().Modified()
    output.Modified()
    return result


def fill_grid_transform(transform, dimensions, ijk_to_ras, grid, deformed, **options):
    """Sets a grid transform to the way from each voxel of the deformed image to its material at
    rest. It is the transform from the parent of a node that hardens a volume into the deformed
    state.

    transform : vtkOrientedGridTransform of Slicer
    dimensions : i, j, k of its grid, at best those of the volume
    options : keywords of tetwarp.displacement_field, such as outside and falloff

    Returns tetwarp.Field, whose values are those of the transform.
    """
    volume_grid = tetwarp.Grid.from_affine(tuple(reversed(dimensions)), ijk_to_ras)
    field = tetwarp.displacement_field(*mesh_of(grid), deformed, reference=volume_grid, **options)
    displacements = vtkImageData()
    displacements.SetDimensions(dimensions)
    displacements.SetSpacing(volume_grid.spacing)
    displacements.SetOrigin(volume_grid.origin)
    vectors = numpy_to_vtk(field.values.reshape(-1, 3))  # which VTK keeps
    vectors.SetName("displacement")
    displacements.GetPointData().SetScalars(vectors)
    directions = vtkMatrix4x4()
    for row in range(3):
        for column in range(3):
            directions.SetElement(row, column, volume_grid.direction[row][column])
    transform.SetGridDirectionMatrix(directions)
    transform.SetDisplacementGridData(displacements)
    transform.SetInterpolationModeToLinear()
    return field
