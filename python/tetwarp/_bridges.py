"""Images and meshes of other packages: nibabel, SimpleITK, PyVista, meshio. Each is imported when it
is needed; none is required.

The axes of the world differ: nibabel's are right, anterior, superior (RAS), those of SimpleITK left,
posterior, superior (LPS). Functions for them take the axes of the caller's world, which meshes
share; PyVista and meshio have no axes of their own.
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from ._arrays import curved_cells_of, integers_of, nodes_of
from ._fields import Field
from ._grid import Grid, reference_grid
from ._mesh import Mesh, joined_cells
from ._values import check_kind
from ._volume import Volume, checked_volume, made_volume


def package(name: str, function: str, pip: str) -> Any:
    """A module, or an ImportError that tells how to install it."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise ImportError(f"{function}: expected {pip}; python3 -m pip install {pip}") from None


def signs_of(axes: str, native: str) -> np.ndarray:
    """What turns x y z of one world into those of the other."""
    if axes not in ("RAS", "LPS"):
        raise ValueError(f"axes: expected 'RAS' or 'LPS', got {axes!r}")
    return np.array((1.0, 1, 1) if axes == native else (-1.0, -1, 1))


def turned(grid: Grid, signs: np.ndarray) -> Grid:
    """A grid in the other world."""
    return Grid(grid.shape, grid.spacing, tuple(signs * grid.origin),
                tuple(map(tuple, signs[:, None] * np.array(grid.direction))))


#: XX YY ZZ XY YZ XZ as NIfTI has symmetric matrices, row by row below the diagonal, and back.
_TO_ROWS, _FROM_ROWS = [0, 3, 1, 5, 4, 2], [0, 2, 5, 1, 4, 3]


def _is_symmetric(image: Any) -> bool:
    """Whether an image of nibabel has symmetric matrices of three rows."""
    has_intent = len(image.shape) == 5 and image.shape[4] == 6 and hasattr(image.header, "get_intent")
    return has_intent and image.header.get_intent("code")[0] == 1005


def _samples_of_nibabel(image: Any) -> np.ndarray:
    """Samples (z, y, x) or (z, y, x, c) of an image of one time, a copy."""
    shape = image.shape
    if len(shape) > 5 or shape[3:4] not in ((), (1,)):
        raise ValueError("image: expected one time, components along the fifth axis, got shape "
                         f"{shape}; image.slicer[:, :, :, n:n+1] is time n")
    array = np.asarray(image.dataobj).reshape(shape[:3] + shape[4:])
    if _is_symmetric(image):
        array = array[..., _FROM_ROWS]
    return np.array(array.swapaxes(0, 2), order="C")


def volume_from(image: Any, *, axes: str) -> Volume:
    """An image of nibabel or SimpleITK as a Volume, a copy.

    Parameters
    ----------
    image : a NIfTI image of nibabel of one time, scaled as its header says, or an image of SimpleITK
    axes : of the world that it is brought to: ``"RAS"`` or ``"LPS"``

    Raises
    ------
    ValueError
        `image` is of another kind or has several times, or `axes` is another word.

    >>> import nibabel
    >>> image = nibabel.Nifti1Image(np.zeros((4, 3, 2), np.int16), np.diag([2, 2, 3, 1]))
    >>> volume_from(image, axes="RAS")
    Volume((2, 3, 4) of int16, spacing (2.0, 2.0, 3.0), name 'values')
    """
    if hasattr(image, "dataobj"):
        grid = reference_grid(image, "image")
        return Volume(_samples_of_nibabel(image), turned(grid, signs_of(axes, "RAS")))
    if hasattr(image, "GetPixelIDTypeAsString"):
        sitk = package("SimpleITK", "volume_from", "SimpleITK")
        grid = turned(reference_grid(image, "image"), signs_of(axes, "LPS"))
        return Volume(sitk.GetArrayFromImage(image), grid)
    raise ValueError(
        f"image: expected an image of nibabel or SimpleITK, got {type(image).__name__}"
    )


def to_nibabel(volume: Volume, *, axes: str) -> Any:
    """A Volume as a `Nifti1Image`; `axes` of its world are ``"RAS"`` or ``"LPS"``. Components are along
    the fifth axis, as vectors, or six as symmetric matrices, as `write` has them.

    Raises
    ------
    ImportError
        nibabel is not installed.

    >>> import nibabel
    >>> image = to_nibabel(Volume(np.zeros((2, 3, 4)), Grid((2, 3, 4))), axes="LPS")
    >>> image.shape, nibabel.aff2axcodes(image.affine)
    ((4, 3, 2), ('L', 'P', 'S'))
    """
    nibabel = package("nibabel", "to_nibabel", "nibabel")
    volume = checked_volume(volume, "volume")
    grid = turned(volume.grid, signs_of(axes, "RAS"))
    array = volume.array.swapaxes(0, 2)
    components = array.shape[3:] if array.shape[3:] != (1,) else ()
    if components == (6,):
        array = array[..., _TO_ROWS]
    shape = array.shape[:3] + (1,) * len(components) + components
    image = nibabel.Nifti1Image(array.reshape(shape), grid.affine, dtype=array.dtype)
    if components:
        image.header.set_intent(*((1005, (3,)) if components == (6,) else (1007,)))
    return image


def _sitk_image(sitk: Any, array: np.ndarray, grid: Grid) -> Any:
    image = sitk.GetImageFromArray(array, isVector=array.ndim == 4)
    image.SetSpacing(grid.spacing)
    image.SetOrigin(grid.origin)
    image.SetDirection(np.ravel(grid.direction).tolist())
    return image


def to_sitk(volume: Volume, *, axes: str) -> Any:
    """A Volume as an image of SimpleITK; `axes` of its world are ``"RAS"`` or ``"LPS"``.

    Raises
    ------
    ImportError
        SimpleITK is not installed.

    >>> import SimpleITK
    >>> image = to_sitk(Volume(np.zeros((2, 3, 4)), Grid((2, 3, 4), (1, 1, 3))), axes="LPS")
    >>> image.GetSize(), image.GetSpacing()
    ((4, 3, 2), (1.0, 1.0, 3.0))
    """
    sitk = package("SimpleITK", "to_sitk", "SimpleITK")
    volume = checked_volume(volume, "volume")
    return _sitk_image(sitk, volume.array, turned(volume.grid, signs_of(axes, "LPS")))


def to_sitk_transform(field: Field, *, axes: str) -> Any:
    """A field of `displacement_field` as a `DisplacementFieldTransform` of SimpleITK, for
    ``SimpleITK.Resample``; `axes` of its world are ``"RAS"`` or ``"LPS"``.

    Raises
    ------
    ImportError
        SimpleITK is not installed.
    ValueError
        `field` has not three components.

    >>> import SimpleITK, tetwarp
    >>> mesh = tetwarp.lattice_mesh(np.ones((8, 8, 8), np.uint8), cells=2)
    >>> moved = tetwarp.deform(*mesh, kind="translate", offset=(0.25, 0, 0))
    >>> field = tetwarp.displacement_field(*mesh, moved, shape=(8, 8, 8))
    >>> to_sitk_transform(field, axes="LPS").TransformPoint((4.0, 4.0, 4.0))
    (3.75, 4.0, 4.0)
    """
    sitk = package("SimpleITK", "to_sitk_transform", "SimpleITK")
    check_kind(field, Field, "field")
    values = made_volume("field", field.values, field.grid).array
    if values.shape[3:] != (3,):
        raise ValueError(f"field: expected displacements, (z, y, x, 3), got {values.shape}")
    signs = signs_of(axes, "LPS")
    image = _sitk_image(sitk, values * signs, turned(field.grid, signs))
    return sitk.DisplacementFieldTransform(image)


def to_pyvista(value: Any, deformed: Any = None) -> Any:
    """A Volume as an `ImageData` of PyVista with the samples at its points, or a mesh, (nodes,
    cells), as an `UnstructuredGrid`, at `deformed` if it is given.

    Raises
    ------
    ImportError
        PyVista is not installed.

    >>> import pyvista
    >>> image = to_pyvista(Volume(np.zeros((2, 3, 4)), Grid((2, 3, 4)), "heat"))
    >>> image.dimensions, image.point_data.keys()
    ((4, 3, 2), ['heat'])
    """
    pyvista = package("pyvista", "to_pyvista", "pyvista")
    if isinstance(value, Volume):
        value = checked_volume(value, "value")
        grid = value.grid
        image = pyvista.ImageData(dimensions=grid.shape[::-1], spacing=grid.spacing,
                                  origin=grid.origin, direction_matrix=np.array(grid.direction))
        image.point_data[value.name] = value.array.reshape(np.prod(grid.shape), -1).squeeze()
        return image
    points, kinds = _parts(value)
    place = points if deformed is None else nodes_of(deformed, "deformed", len(points))
    types = {"tetra": pyvista.CellType.TETRA, "tetra10": pyvista.CellType.QUADRATIC_TETRA,
             "hexahedron": pyvista.CellType.HEXAHEDRON}
    return pyvista.UnstructuredGrid({types[kind]: part for kind, part in kinds.items()}, place)


def _parts(mesh: Any) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Nodes, and the cells of each kind by its name in meshio, which has VTK's order of nodes: the
    order of the mesh, but tetrahedra of four nodes are before those of ten."""
    points = nodes_of(mesh[0], "nodes")
    tets, hexes, mids = curved_cells_of(mesh[1], "cells", len(points))
    curved = (mids >= 0).any(axis=1) if len(mids) else np.zeros(len(tets), bool)
    ten = np.hstack([tets, mids])[curved] if curved.any() else tets[:0]
    kinds = {"tetra": tets[~curved], "tetra10": ten, "hexahedron": hexes}
    return points, {kind: part for kind, part in kinds.items() if len(part)}


def to_meshio(mesh: Any, **data: Any) -> Any:
    """A mesh, (nodes, cells), as a `meshio.Mesh`; `data` are further arguments, as point_data.

    Raises
    ------
    ImportError
        meshio is not installed.

    >>> import meshio
    >>> tet = np.eye(4, 3), [(0, 1, 2, 3)]
    >>> to_meshio(tet, point_data={"heat": np.arange(4.0)}).cells_dict["tetra"].tolist()
    [[0, 1, 2, 3]]
    """
    meshio = package("meshio", "to_meshio", "meshio")
    points, kinds = _parts(mesh)
    return meshio.Mesh(points, list(kinds.items()), **data)


def mesh_from(mesh: Any) -> Mesh:
    """The tetrahedra, of four nodes and then of ten, and hexahedra of a `meshio.Mesh` or an
    `UnstructuredGrid` of PyVista.

    Raises
    ------
    ValueError
        it is none of these, has none, or cells of other volume elements, which would be missing.

    >>> import types
    >>> blocks = {"tetra": np.array([(0, 1, 2, 3)])}
    >>> mesh_from(types.SimpleNamespace(points=np.eye(4, 3), cells_dict=blocks))
    Mesh(4 nodes, 1 cells)
    """
    if not hasattr(mesh, "cells_dict"):
        raise ValueError("mesh: expected a mesh of meshio or an UnstructuredGrid of PyVista, got "
                         f"{type(mesh).__name__}")
    kinds = {10: "tetra", 12: "hexahedron", 24: "tetra10"}  # numbers of VTK
    blocks: dict[Any, Any] = {}
    for kind, part in mesh.cells_dict.items():
        blocks[kinds.get(kind, kind)] = part
    flat = {"vertex", "line", "triangle", "quad", "line3", "triangle6", 1, 3, 5, 9, 21, 22}
    others = [str(kind) for kind in blocks if kind not in kinds.values() and kind not in flat]
    if others:
        raise ValueError(
            "mesh: expected tetrahedra of four or ten nodes and hexahedra of eight, found cells of "
            f"{', '.join(others)}"
        )
    points = nodes_of(mesh.points, "mesh")
    parts = {name: integers_of(blocks.get(name, ()), "mesh", np.int64).reshape(-1, count)
             for name, count in (("tetra", 4), ("tetra10", 10), ("hexahedron", 8))}
    tets, ten = parts["tetra"], parts["tetra10"]
    if len(ten):
        tets = np.vstack([np.pad(tets, ((0, 0), (0, 6)), constant_values=-1), ten])
    return Mesh(points, joined_cells(*curved_cells_of((tets, parts["hexahedron"]), "mesh",
                                                      len(points))))
