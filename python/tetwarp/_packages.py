"""Files for which tetwarp-read was built without the library, as in wheels: they are read by packages
of Python, where these are installed."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from . import _core
from ._arrays import curved_cells_of
from ._bridges import mesh_from
from ._dicom import read_dicom
from ._grid import Grid
from ._mesh import Surface
from ._volume import Volume


def _package(name: str, pip: str, error: Exception) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        lacking = _core.MissingLibrary(f"{error}; in Python: python3 -m pip install {pip}")
        lacking.library = name
        raise lacking from None


def _meshio_mesh(path: str, error: Exception) -> Any:
    meshio = _package("meshio", "meshio", error)
    try:
        return meshio.read(path)
    except (Exception, SystemExit) as reason:  # it ends the program on some damaged files
        raise _core.IoError(f"{error}; meshio cannot read it: {reason}") from None


def check_default(path: str, name: str, value: Any, default: Any) -> None:
    """Raises IoError for an argument that the packages do not take."""
    if value != default:
        raise _core.IoError(f"{path}: {name}: {value!r} needs tetwarp-read with VTK and GDCM; "
                            f"without these it is {default!r}")


class MeshioFile:
    """A mesh file by meshio, with the members of _core.MeshFile: at most one step, of the point array
    `displacement`.
    """

    def __init__(self, path: str, rest_step: int, axes: str, error: Exception) -> None:
        check_default(path, "rest_step", rest_step, 0)
        read = _meshio_mesh(path, error)
        try:
            self._mesh = mesh_from(read)
        except ValueError as reason:
            raise _core.IoError(f"{path}: {reason}") from None
        self._turn = np.array((-1.0, -1, 1) if axes == "lps" else (1.0, 1, 1))
        names = [*read.point_data, *read.cell_data]
        self._shift = read.point_data.get("displacement")
        if self._shift is not None:
            numbers = np.asarray(self._shift)
            if numbers.shape != self._mesh.points.shape or not np.isfinite(numbers).all():
                raise _core.IoError(f"{path}: displacement: expected three finite numbers for each "
                                    f"of {len(self._mesh.points)} nodes")
        self.times = [] if self._shift is None else [0.0]
        self.not_read = [name for name in names if name != "displacement"]

    def mesh(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Nodes at rest, corners of tetrahedra, hexahedra, nodes on edges of tetrahedra."""
        points, cells = self._mesh
        return points * self._turn, *curved_cells_of(cells, "cells", len(points))

    def read_step(self, step: int) -> np.ndarray:
        """Positions of the nodes."""
        return (self._mesh.points + self._shift) * self._turn


def read_surface(path: str, error: Exception) -> Surface:
    """The triangles of a file by meshio; points at one place are joined."""
    read = _meshio_mesh(path, error)
    others = sorted(set(read.cells_dict) - {"triangle", "line", "vertex"})
    if others or "triangle" not in read.cells_dict:
        raise _core.IoError(f"{path}: expected triangles, found {', '.join(others) or 'none'}")
    points, places = np.unique(np.asarray(read.points, float), axis=0, return_inverse=True)
    triangles = places.reshape(-1)[read.cells_dict["triangle"]]
    return Surface(points, triangles.astype(np.int32))


def read_image(path: str, array: str, error: _core.MissingLibrary) -> Volume:
    """A DICOM file by pydicom, a .vti by VTK."""
    if error.library == "GDCM":
        _package("pydicom", "pydicom", error)
        check_default(path, "array", array, "")
        try:
            return read_dicom(path, axes="RAS")
        except ValueError as reason:
            raise _core.IoError(f"{path}: {str(reason).removeprefix('source: ')}") from None
    reader = _package("vtkmodules.vtkIOXML", "vtk", error).vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    points = image.GetPointData()
    samples = points.GetArray(array) if array else points.GetScalars() or points.GetArray(0)
    if samples is None:
        raise _core.IoError(f"{path}: VTK finds no array {array or 'at its points'}")
    numbers = importlib.import_module("vtkmodules.util.numpy_support").vtk_to_numpy(samples)
    turn = image.GetDirectionMatrix()
    grid = Grid(
        image.GetDimensions()[::-1], image.GetSpacing(), image.GetPoint(0),
        tuple(tuple(turn.GetElement(row, column) for column in range(3)) for row in range(3)),
    )
    shape = grid.shape + numbers.shape[1:]
    return Volume(numbers.reshape(shape).copy(), grid, samples.GetName() or "values")
