"""Files: volumes, meshes, surfaces and contact problems."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Iterator, Sequence

import numpy as np

from . import _core
from ._arrays import curved_cells_of, nodes_of, numbers_of, samples_of, triangles_of
from ._contact import ContactProblem
from ._fields import Field
from ._grid import Grid, grid_from_core, reference_grid
from ._mesh import Mesh, Surface, joined_cells, split_ten_nodes
from ._packages import MeshioFile, check_default, read_image, read_surface
from ._result import WarpResult
from ._values import flag_of, integer_of, list_of, path_of, warn, word_of
from ._volume import Volume, checked_volume, made_volume

#: Ends of names of files that are packed by the level that `compress` gives.
_PACKED = (".vtkhdf", ".hdf", ".h5", ".nii.gz", ".nrrd", ".mha", ".mhd", ".mgz")
_ITK_FIELDS = ("tetwarp_displacement", "tetwarp_forward")


def _check_unused(owner: str, given: dict[str, bool]) -> None:
    """Raises ValueError for an argument that would have no effect."""
    for name, is_given in given.items():
        if is_given:
            raise ValueError(f"{name}: has no effect on a {owner}; leave it out")


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
        name, step = path_of(path), integer_of(rest_step, "rest_step", 2**63 - 1)
        if word_of(ten_nodes, "ten_nodes") not in ("curved", "split"):
            raise ValueError(f"ten_nodes: expected curved or split, got {ten_nodes!r}")
        self._file: Any
        turns = word_of(axes, "axes") != "ras"
        if turns and not _core.has_mesh_extension(name) and _core.kind_of(name) == "mesh":
            _check_unused("mesh of VTKHDF", {"axes": turns})
        try:
            self._file = _core.MeshFile(name, step, axes, ten_nodes == "curved")
        except _core.MissingLibrary as error:
            self._file = MeshioFile(name, step, axes, error)
        points, *parts = self._file.mesh()
        cells = joined_cells(*parts)
        self.mesh = Mesh(points, split_ten_nodes(cells) if ten_nodes == "split" else cells)
        self.times: list[float] = list(self._file.times)
        self._count = len(self.times)
        self.not_read: list[str] = list(self._file.not_read)

    def step(self, number: int) -> np.ndarray:
        """Deformed positions (n, 3) of a step; negative numbers count from the end."""
        count, number = self._count, integer_of(number, "number")
        if not -count <= number < count:
            raise ValueError(f"number: expected a step from 0 to {count - 1}, got {number}")
        return self._file.read_step(number % count)

    def __len__(self) -> int:
        return self._count

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
    """Reads the header of a volume file of any format.

    Raises IoError as read().

    >>> import os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "steps.vtkhdf")
    ...     write(path, [np.zeros((2, 3, 4))] * 2, grid=Grid((2, 3, 4)), times=[0, 0.5])
    ...     header = read_header(path)
    >>> header.grid.shape, header.arrays[0]["dtype"], header.times
    ((2, 3, 4), 'float64', [0.0, 0.5])
    """
    header = _core.volume_header(path_of(path))
    return VolumeHeader(**{**header, "grid": grid_from_core(header["grid"])})


def read(
    path: Any, *, array: str = "", step: int = 0, axes: str = "ras", labels: bool = False,
    ten_nodes: str = "curved",
) -> Any:
    """Reads a file: volumes, VTKHDF files and contact problems by their content, others by the end of
    the name, in small or capital letters.

    Parameters
    ----------
    path : volume: VTKHDF ImageData, NIfTI (also pairs of ``.hdr`` and ``.img``), ``.nrrd``, ``.nhdr``,
        ``.mha``, ``.mhd``, ``.mgh``, ``.mgz``, ``.vti``, a file or folder of DICOM;
        mesh: VTKHDF UnstructuredGrid, ``.msh``, ``.vtu``, ``.vtk``, Exodus (``.e``, ``.exo``,
        ``.ex2``), the steps that a ``.pvd``, ``.vtu.series`` or ``.vtk.series`` lists or that a name
        with ``*`` matches, the blocks of a ``.vtm``;
        surface: VTKHDF, ``.stl``, ``.ply``, ``.obj``, ``.vtp``; or contact problem: FCLIB
    array : of a volume file; empty: its active scalars
    step : of a volume file
    axes : ``"ras"`` or ``"lps"``, of vectors and tensors of NIfTI, NRRD and MetaImage files and
        of the nodes of meshes that are not VTKHDF; ``"lps"`` is refused where it would turn nothing
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
    name, number = path_of(path), integer_of(step, "step", 2**63 - 1)
    if not isinstance(array, str):
        raise ValueError(f"array: expected a name, got {array!r}")
    are_labels = flag_of(labels, "labels")
    of_volumes = {"array": array != "", "step": number != 0, "labels": are_labels}
    turns = {"axes": word_of(axes, "axes") != "ras"}
    of_meshes = {"ten_nodes": word_of(ten_nodes, "ten_nodes") != "curved"}
    if _core.has_mesh_extension(name):
        _check_unused("mesh", of_volumes)
        return MeshFile(name, axes=axes, ten_nodes=ten_nodes)
    is_surface = _core.is_surface_file(name)
    try:
        if is_surface:
            _check_unused("surface", of_volumes | turns | of_meshes)
            return Surface(*_core.read_surface(name))
        kind = _core.kind_of(name)
        if kind == "mesh":
            _check_unused("mesh of VTKHDF", of_volumes | turns)
            return MeshFile(name, ten_nodes=ten_nodes)
        if kind == "contact problem":
            _check_unused(kind, of_volumes | turns | of_meshes)
            return ContactProblem(**_core.read_contact_problem(name))
        _check_unused("volume", of_meshes)
        if not _core.has_component_axes(name):  # of others the library refuses scalars
            _check_unused("volume that is no NIfTI, NRRD or MetaImage file", turns)
        samples, grid, read_name, nifti = _core.read_volume(
            name, array, number, axes, are_labels)
    except _core.MissingLibrary as error:
        if is_surface:
            return read_surface(name, error)
        check_default(name, "step", step, 0)
        check_default(name, "labels", are_labels, False)
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
    if isinstance(value, (Field, Volume)):
        if grid is not None and grid != value.grid:
            raise ValueError(f"grid: {where} has one; leave it out")
        return checked_volume(value, where) if isinstance(value, Volume) else made_volume(
            where, value.values, value.grid, value.name)
    samples = samples_of(value, where)
    if grid is None:
        raise ValueError(f"grid: an array needs its grid; {where} is one")
    return Volume(samples, grid)


def _volumes_of(result: WarpResult) -> list[Volume]:
    """All arrays of a warp, with the names that the command gives them."""
    if not len(result.volumes) == len(result.names) == len(result.nifti):
        raise ValueError(f"value: expected a name and a header of NIfTI or None for each of "
                         f"{len(result.volumes)} volumes, got {len(result.names)} and "
                         f"{len(result.nifti)}")
    volumes = [
        Volume(array, result.grid, name, nifti)
        for array, name, nifti in zip(result.volumes, result.names, result.nifti)
    ]
    return volumes + [
        Volume(array, result.grid, "tetwarp_" + ("tet" if name == "owner" else name))
        for name, array in result.extras.items()
    ]


def _warn_of_times(path: str, times: list[float]) -> None:
    text = _core.times_warning(path, times)
    if text:
        warn(text)


def _write_volumes(
    path: str, value: Any, grid: Grid | None, times: Any, compress: int
) -> None:
    if isinstance(value, WarpResult):
        _check_unused("result of a warp, which has one", {"grid": grid is not None})
        value = _volumes_of(value)
    if not path.lower().endswith(_PACKED):
        ending = path[path.rfind("."):]
        _check_unused(f"volume of {ending}, which is not packed", {"compress": compress != 0})
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
        times = numbers_of(times, "times", len(volumes)).tolist()
        for number, volume in enumerate(volumes):
            if volume.shape != first.shape or volume.dtype != first.dtype:
                raise ValueError(f"value[{number}]: expected shape and type of value[0]")
            if volume.name != first.name:
                raise ValueError(f"value[{number}]: expected the name of value[0], whose steps they are")
        arrays = [_entry(first.name, [volume.array for volume in volumes], first.nifti)]
        _warn_of_times(path, times)
    _core.write_volumes(
        path, first.grid._core(), arrays, times or [], compress,
    )


def _write_mesh(path: str, mesh: Mesh, deformed: Any, times: Any) -> None:
    points = nodes_of(mesh.points, "points")
    parts = curved_cells_of(mesh.cells, "cells", len(points))
    steps = [] if deformed is None else list_of(deformed, "deformed", "a list of positions")
    moved = [nodes_of(step, f"deformed[{n}]", len(points)) for n, step in enumerate(steps)]
    if times is None:
        last = max(len(moved) - 1, 1)
        times = [number / last for number in range(len(moved))] if len(moved) != 1 else [1.0]
    of_steps = numbers_of(times, "times", len(moved)).tolist()
    _warn_of_times(path, of_steps)
    _core.write_mesh(path, points, *parts, [step - points for step in moved], of_steps)


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
    compress : 0 to 9, deflate level of volumes; of ``.nii``, ``.mgh`` and ``.vti``, which are not
        packed, 0

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
    name = path_of(path)
    grid = None if grid is None else reference_grid(grid, "grid")
    level = integer_of(compress, "compress")
    of_volumes = {"grid": grid is not None, "compress": level != 0}
    of_meshes = {"deformed": deformed is not None}
    if not isinstance(value, ContactProblem):
        _check_ending(name, isinstance(value, (Mesh, Surface)))
    if isinstance(value, Mesh):
        _check_unused("mesh", of_volumes)
        _write_mesh(name, value, deformed, times)
    elif isinstance(value, Surface):
        _check_unused("surface", of_volumes | of_meshes | {"times": times is not None})
        points = nodes_of(value.points, "points")
        _core.write_surface(name, points, triangles_of(value.triangles, "triangles", len(points)))
    elif isinstance(value, ContactProblem):
        _check_unused("contact problem", of_volumes | of_meshes | {"times": times is not None})
        _core.write_contact_problem(name, value._core(), "", "")
    else:
        _check_unused("volume", of_meshes)
        _write_volumes(name, value, grid, times, level)
