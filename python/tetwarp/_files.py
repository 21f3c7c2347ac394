"""Files: volumes (VTKHDF, NIfTI), meshes (VTKHDF, Gmsh, VTK), contact problems (FCLIB)."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Iterator, Sequence

import numpy as np

from . import _core
from ._arrays import curved_cells_of, integer_of, nodes_of, number_of, triangles_of
from ._contact import ContactProblem
from ._fields import Field
from ._grid import Grid, grid_from_core
from ._mesh import Mesh, Surface, joined_cells, split_ten_nodes
from ._packages import MeshioFile, check_default, is_lacking, read_image, read_surface
from ._result import WarpResult
from ._volume import Volume

_ITK_FIELDS = ("tetwarp_displacement", "tetwarp_forward")


class MeshFile:
    """A mesh file and its steps, which are read when they are asked for. Tetrahedra of ten nodes stay
    what they are, or are split_ten_nodes() with ``ten_nodes="split"``.

    mesh : the Mesh at rest
    times : one per step
    not_read : what the file holds beside

    >>> import os, tempfile
    >>> mesh = Mesh(np.eye(4, 3), np.array([(0, 1, 2, 3)]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "mesh.vtkhdf")
    ...     write(path, mesh, deformed=[mesh.points + 1])
    ...     file = MeshFile(path)
    ...     file, float((file.step(0) - file.mesh.points).max())
    (MeshFile(4 nodes, 1 cells, 1 steps), 1.0)
    """

    def __init__(
        self, path: Any, *, rest_step: int = 0, axes: str = "ras", ten_nodes: str = "curved"
    ) -> None:
        name, step = os.fspath(path), integer_of(rest_step, "rest_step")
        if ten_nodes not in ("curved", "split"):
            raise ValueError(f"ten_nodes: expected curved or split, got {ten_nodes!r}")
        self._file: Any
        try:
            self._file = _core.MeshFile(name, step, axes, ten_nodes == "curved")
        except _core.IoError as error:
            if not is_lacking(error):
                raise
            self._file = MeshioFile(name, step, axes, error)
        points, *parts = self._file.mesh()
        cells = joined_cells(*parts)
        self.mesh = Mesh(points, split_ten_nodes(cells) if ten_nodes == "split" else cells)
        self.times: list[float] = list(self._file.times)
        self.not_read: list[str] = list(self._file.not_read)

    def step(self, number: int) -> np.ndarray:
        """Deformed positions (n, 3) of a step; negative numbers count from the end."""
        count = len(self.times)
        if not -count <= number < count:
            raise ValueError(f"number: expected a step from 0 to {count - 1}, got {number}")
        return self._file.read_step(number % count)

    def __len__(self) -> int:
        return len(self.times)

    def __iter__(self) -> Iterator[np.ndarray]:
        return (self.step(number) for number in range(len(self)))

    def __repr__(self) -> str:
        mesh = self.mesh
        return f"MeshFile({len(mesh.points)} nodes, {mesh.cell_count} cells, {len(self)} steps)"


@dataclass
class VolumeHeader:
    """What a volume file holds, without samples.

    grid : of all arrays
    arrays : a dict per array: name, dtype, components
    active : the array that is read when none is named
    times : one per step; empty: no steps
    not_read : what the file holds beside
    """

    grid: Grid
    arrays: list[dict[str, Any]]
    active: str
    times: list[float]
    not_read: list[str]


def read_header(path: Any) -> VolumeHeader:
    """Reads the header of a volume file.

    Raises IoError as read().
    """
    header = _core.volume_header(os.fspath(path))
    return VolumeHeader(**{**header, "grid": grid_from_core(header["grid"])})


def read(
    path: Any, *, array: str = "", step: int = 0, axes: str = "ras", labels: bool = False,
    ten_nodes: str = "curved",
) -> Any:
    """Reads a file, by its content.

    Parameters
    ----------
    path : volume (VTKHDF ImageData, NIfTI), mesh (VTKHDF UnstructuredGrid, .msh, .vtu, .vtk),
        surface (VTKHDF, .stl, .ply, .obj, .vtp) or contact problem (FCLIB)
    array : of a volume file; empty: its active scalars
    step : of a volume file
    axes : ``"ras"`` or ``"lps"``, of the components of images and of the nodes of meshes that are
        not VTKHDF
    labels : floats hold labels: they are read as int32, other numbers are an error
    ten_nodes : ``"curved"``: tetrahedra of ten nodes stay what they are, cells of shape (m, 10);
        ``"split"``: they become eight straight ones, see split_ten_nodes()

    Returns
    -------
    Volume, MeshFile, Surface or ContactProblem, whose impulse_guess is the file's solution or guess

    Raises
    ------
    IoError
        an OSError: one line that names the file, the dataset and the remedy.

    >>> import os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "zeros.nii.gz")
    ...     write(path, np.zeros((2, 3, 4), np.int16), grid=Grid((2, 3, 4), spacing=(1, 1, 2)))
    ...     read(path)
    Volume((2, 3, 4) of int16, spacing (1.0, 1.0, 2.0), name 'values')
    """
    name = os.fspath(path)
    if _core.has_mesh_extension(name):
        return MeshFile(name, axes=axes, ten_nodes=ten_nodes)
    is_surface = _core.is_surface_file(name)
    try:
        if is_surface:
            return Surface(*_core.read_surface(name))
        kind = _core.kind_of(name)
        if kind == "mesh":
            return MeshFile(name, ten_nodes=ten_nodes)
        if kind == "contact problem":
            return ContactProblem(**_core.read_contact_problem(name))
        samples, grid, read_name, nifti = _core.read_volume(
            name, array, integer_of(step, "step"), axes, bool(labels))
    except _core.IoError as error:
        if not is_lacking(error):
            raise
        if is_surface:
            return read_surface(name, error)
        check_default(name, "step", step, 0)
        check_default(name, "axes", axes, "ras")
        check_default(name, "labels", labels, False)
        return read_image(name, array, error)
    return Volume(samples, grid_from_core(grid), read_name, nifti)


def _entry(name: str, samples: Sequence[np.ndarray], nifti: Any) -> dict[str, Any]:
    return {
        "name": name,
        "samples": list(samples),
        "nifti": nifti,
        "is_itk_field": name in _ITK_FIELDS and samples[0].shape[3:] == (3,),
    }


def _volume_of(value: Any, grid: Grid | None, where: str) -> Volume:
    if isinstance(value, Field):
        return Volume(value.values, value.grid, value.name)
    if isinstance(value, Volume):
        return value
    if grid is None:
        raise ValueError(f"grid: an array needs its grid; {where} is one")
    return Volume(value, grid)


def _volumes_of(result: WarpResult) -> list[Volume]:
    """All arrays of a warp, with the names that the command gives them."""
    volumes = [
        Volume(array, result.grid, name, nifti)
        for array, name, nifti in zip(result.volumes, result.names, result.nifti)
    ]
    return volumes + [
        Volume(array, result.grid, "tetwarp_" + ("tet" if name == "owner" else name))
        for name, array in result.extras.items()
    ]


def _write_volumes(
    path: str, value: Any, grid: Grid | None, times: Sequence[float] | None, compress: int
) -> None:
    if isinstance(value, WarpResult):
        value = _volumes_of(value)
    many = list(value) if isinstance(value, (list, tuple)) else [value]
    if not many:
        raise ValueError("value: expected at least one volume")
    volumes = [_volume_of(one, grid, f"value[{number}]") for number, one in enumerate(many)]
    first = volumes[0]
    for number, volume in enumerate(volumes):
        if volume.grid != first.grid:
            raise ValueError(f"value[{number}]: expected the grid of value[0]")
    if times is None:
        arrays = [_entry(volume.name, [volume.array], volume.nifti) for volume in volumes]
    else:
        if len(times) != len(volumes):
            raise ValueError(f"times: expected {len(volumes)}, one per volume, got {len(times)}")
        for number, volume in enumerate(volumes):
            if volume.shape != first.shape or volume.dtype != first.dtype:
                raise ValueError(f"value[{number}]: expected shape and type of value[0]")
        arrays = [_entry(first.name, [volume.array for volume in volumes], first.nifti)]
    _core.write_volumes(
        path, first.grid._core(), arrays, [number_of(t, "times") for t in times or ()],
        integer_of(compress, "compress"),
    )


def _write_mesh(path: str, mesh: Mesh, deformed: Any, times: Sequence[float] | None) -> None:
    points = nodes_of(mesh.points, "points")
    parts = curved_cells_of(mesh.cells, "cells", len(points))
    steps = [] if deformed is None else list(deformed)
    moved = [nodes_of(step, f"deformed[{n}]", len(points)) for n, step in enumerate(steps)]
    if times is None:
        last = max(len(moved) - 1, 1)
        times = [number / last for number in range(len(moved))] if len(moved) != 1 else [1.0]
    if len(times) != len(moved):
        raise ValueError(f"times: expected {len(moved)}, one per step, got {len(times)}")
    _core.write_mesh(
        path, points, *parts, [step - points for step in moved],
        [number_of(t, "times") for t in times],
    )


def _check_ending(path: str, is_mesh: bool) -> None:
    """Raises ValueError if a name is that of another format."""
    endings = _core.vtkhdf_endings if is_mesh else _core.volume_endings
    if not path.lower().endswith(endings):
        kind = "mesh or a surface" if is_mesh else "volume"
        raise ValueError(f"path: {path}: expected a name of a {kind}, which ends in "
                         f"{', '.join(endings)}")


def write(
    path: Any,
    value: Any,
    *,
    grid: Grid | None = None,
    times: Sequence[float] | None = None,
    deformed: Any = None,
    compress: int = 0,
) -> None:
    """Writes a file; it gets its name when it is complete.

    Parameters
    ----------
    path : its ending is the format: VTKHDF (``.vtkhdf``, ``.hdf``, ``.h5``), of meshes and surfaces
        always; of volumes also ``.nii``, ``.nii.gz``, ``.nrrd``, ``.mha``, ``.mhd``, ``.mgh``,
        ``.mgz`` or ``.vti``; contact problems are FCLIB under any name
    value : Volume, Field or samples (with `grid`), a list of these on one grid, a WarpResult, a
        Mesh, a Surface or a ContactProblem; a NIfTI file takes one array
    grid : of samples
    times : of several volumes: they are the steps of one array; of a mesh: one per step
    deformed : of a mesh: node positions (n, 3) per step
    compress : 0 to 9, deflate level of volumes

    Raises
    ------
    IoError
        the file cannot be written.
    ValueError
        naming the argument.

    >>> import os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "two.vtkhdf")
    ...     write(path, [Volume(np.zeros((2, 2, 2)), Grid((2, 2, 2)), n) for n in ("a", "b")])
    ...     [entry["name"] for entry in read_header(path).arrays]
    ['a', 'b']
    """
    name = os.fspath(path)
    if not isinstance(value, ContactProblem):
        _check_ending(name, isinstance(value, (Mesh, Surface)))
    if isinstance(value, Mesh):
        _write_mesh(name, value, deformed, times)
    elif isinstance(value, Surface):
        points = nodes_of(value.points, "points")
        _core.write_surface(name, points, triangles_of(value.triangles, "triangles", len(points)))
    elif isinstance(value, ContactProblem):
        _core.write_contact_problem(name, value._core(), "", "")
    else:
        _write_volumes(name, value, grid, times, compress)
