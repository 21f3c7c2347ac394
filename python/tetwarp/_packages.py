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
from ._mesh import Mesh, Surface, joined_cells
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


def _without_copies(mesh: Mesh) -> Mesh:
    """The mesh without cells that are there twice, as tetwarp-read reads it."""
    points, cells = mesh
    tets, hexes, mids = curved_cells_of(cells, "cells", len(points))
    first_tets, first_hexes = _core.first_cells(points, tets, hexes, mids)
    is_first = first_tets.view(bool)
    return Mesh(points, joined_cells(tets[is_first], hexes[first_hexes.view(bool)],
                                     mids[is_first] if len(mids) else mids))


class MeshioFile:
    """A mesh file by meshio, with the members of _core.MeshFile: at most one step, of the point array
    `displacement`.
    """

    def __init__(self, path: str, rest_step: int, axes: str, error: Exception) -> None:
        check_default(path, "rest_step", rest_step, 0)
        read = _meshio_mesh(path, error)
        try:
            self._mesh = _without_copies(mesh_from(read))
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


def _joined_seams(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Triangles whose points on edges of a single triangle are joined where they are equal, as
    tetwarp-read does it.
    """
    edges = np.sort(triangles[:, [(0, 1), (1, 2), (2, 0)]].reshape(-1, 2))
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    seam = np.unique(unique[uses == 1])
    seam = seam[np.isfinite(points[seam]).all(axis=1)]
    joined = np.arange(len(points))
    _, first, place = np.unique(points[seam] + 0.0, axis=0, return_index=True, return_inverse=True)
    joined[seam] = seam[first[place.reshape(-1)]]
    return joined[triangles]


def read_surface(path: str, error: Exception) -> Surface:
    """The triangles of a file by meshio, with seams joined and repeated ones left out."""
    read = _meshio_mesh(path, error)
    others = sorted(set(read.cells_dict) - {"triangle", "line", "vertex"})
    if others or "triangle" not in read.cells_dict:
        raise _core.IoError(f"{path}: expected triangles, found {', '.join(others) or 'none'}")
    points = np.asarray(read.points, float)
    triangles = _joined_seams(points, read.cells_dict["triangle"]).astype(np.int32)
    triangles = triangles[_core.first_triangles(points, triangles).view(bool)]
    used, places = np.unique(triangles, return_inverse=True)
    return Surface(points[used], places.reshape(-1, 3).astype(np.int32))


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
