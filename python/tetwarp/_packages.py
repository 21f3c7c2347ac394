"""Files for which tetwarp-read was built without the library, as in wheels: they are read by packages
of Python, where these are installed."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from . import _core
from ._arrays import cells_of
from ._bridges import mesh_from
from ._dicom import read_dicom
from ._grid import Grid
from ._mesh import Surface
from ._volume import Volume


def is_lacking(error: Exception) -> bool:
    """Whether a file was not read because tetwarp-read lacks a library."""
    return "this build cannot read" in str(error)


def _package(name: str, pip: str, error: Exception) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise _core.IoError(f"{error}; in Python: python3 -m pip install {pip}") from None


def _meshio_mesh(path: str, error: Exception) -> Any:
    meshio = _package("meshio", "meshio", error)
    try:
        return meshio.read(path)
    except (Exception, SystemExit) as reason:  # it ends the program on some damaged files
        raise _core.IoError(f"{path}: meshio cannot read it: {reason}") from None


class MeshioFile:
    """A mesh file by meshio, with the members of _core.MeshFile: at most one step, of the point array
    `displacement`.
    """

    def __init__(self, path: str, axes: str, error: Exception) -> None:
        read = _meshio_mesh(path, error)
        try:
            self._mesh = mesh_from(read)
        except ValueError as reason:
            raise _core.IoError(f"{path}: {reason}") from None
        self._turn = np.array((-1.0, -1, 1) if axes == "lps" else (1.0, 1, 1))
        names = [*read.point_data, *read.cell_data]
        self._shift = read.point_data.get("displacement")
        self.times = [] if self._shift is None else [0.0]
        self.not_read = [name for name in names if name != "displacement"]

    def mesh(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nodes at rest, tetrahedra, hexahedra."""
        points, cells = self._mesh
        return points * self._turn, *cells_of(cells, "cells", len(points))

    def read_step(self, step: int) -> np.ndarray:
        """Positions of the nodes."""
        return (self._mesh.points + self._shift) * self._turn


def read_surface(path: str, error: Exception) -> Surface:
    """The triangles of a file by meshio."""
    read = _meshio_mesh(path, error)
    others = sorted(set(read.cells_dict) - {"triangle", "line", "vertex"})
    if others or "triangle" not in read.cells_dict:
        raise _core.IoError(f"{path}: expected triangles, found {', '.join(others) or 'none'}")
    return Surface(np.asarray(read.points, float), read.cells_dict["triangle"].astype(np.int32))


def read_image(path: str, array: str, error: Exception) -> Volume:
    """A DICOM file by pydicom, a .vti by VTK."""
    if "DICOM" in str(error):
        _package("pydicom", "pydicom", error)
        return read_dicom(path, axes="RAS")
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
