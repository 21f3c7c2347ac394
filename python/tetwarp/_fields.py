"""Fields of a deformation on a grid, and points that it moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _core
from ._arrays import as_array, cells_of, curved_cells_of, maker_of, nodes_of, points_of
from ._grid import Grid, make_grid, reference_grid
from ._mesh import Cells
from ._result import WarpResult
from ._values import flag_of, number_of, warn
from ._volume import Volume
from ._warper import Warper

_CONVENTIONS = {"resampling": "displacement", "modeling": "forward"}


@dataclass(eq=False)
class Field:
    """Numbers of a deformation at the voxels of a grid; ``numpy.asarray(field)`` is `values`.

    values : (z, y, x) or (z, y, x, c) float32; 0 where `mask` is False, but see `outside` of
        displacement_field()
    mask : (z, y, x) bool, where a cell covers the voxel
    grid : of both
    name : of the array in files
    """

    values: np.ndarray
    mask: np.ndarray
    grid: Grid
    name: str

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return as_array(self.values, dtype, copy)

    def __repr__(self) -> str:
        return f"Field({self.name}, {self.values.shape}, {self.mask.mean():.1%} covered)"


def grid_of(
    reference: Any, shape: Any, spacing: Any, origin: Any, direction: Any, affine: Any
) -> Grid:
    if reference is not None:
        if any(x is not None for x in (shape, spacing, origin, direction, affine)):
            raise ValueError("reference: it has a grid; leave out shape, spacing and the like")
        return reference_grid(reference)
    if shape is None:
        raise ValueError("reference: expected a grid, by reference or by shape")
    return make_grid(shape, spacing, origin, direction, affine)


def _check_options(options: Any, others: tuple[str, ...] = ()) -> None:
    for name in options:
        if name not in ("backend", "device", "threads", *others):
            raise TypeError(f"unexpected keyword argument {name!r}")


def _outputs_on(
    grid: Grid, rest: Any, cells: Cells, deformed: Any, names: tuple[str, ...], options: Any
) -> WarpResult:
    """Outputs of a warp other than its volume, which is one byte per voxel."""
    _check_options(options, ("outside", "falloff") if "displacement" in names else ())
    shape = grid.shape if "forward" in names else (1, 1, 1)
    samples = np.zeros(shape, np.uint8)
    source = Volume(samples, Grid(shape, grid.spacing, grid.origin, grid.direction))
    with Warper(source, rest, cells, interpolator="nearest", reference=grid, **options) as warper:
        return warper(deformed, outputs=names)


def _field(name: str, title: str, grid: Grid, rest: Any, cells: Cells, deformed: Any,
           options: Any) -> Field:
    result = _outputs_on(grid, rest, cells, deformed, (name, "mask"), options)
    mask = result.extras["mask"].view(bool)
    if name == "forward":  # covered at rest, unlike the mask of the deformed mesh
        mask = rasterize(rest, cells, reference=grid, **options) >= 0
    return Field(result.extras[name], mask, grid, title)


def displacement_field(
    rest: Any,
    cells: Cells,
    deformed: Any,
    *,
    reference: Any = None,
    shape: Any = None,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    affine: Any = None,
    convention: str = "resampling",
    **options: Any,
) -> Field:
    """Displacements at the voxels of a grid.

    Parameters
    ----------
    rest, deformed : (n, 3) node positions before and after [world]
    cells : (m, 4) or (m, 10), (k, 8), or a pair of both, as of Warper
    reference : Grid, or something that has one; or `shape` (z, y, x) with the keywords of Grid
    convention : ``"resampling"``: from the voxel of the deformed image to the rest position, as
        image resamplers take it; ``"modeling"``: from the voxel at rest to the deformed position,
        not of tetrahedra of ten nodes
    options : backend, device, threads, as of Warper; for ``"resampling"`` also outside and falloff:
        ``"nearest"`` and ``"falloff"`` move voxels that no cell covers

    Returns
    -------
    Field of shape (z, y, x, 3), x y z in world units; `write` stores it as ITK's transforms take it

    >>> import tetwarp
    >>> mesh = tetwarp.lattice_mesh(np.ones((8, 8, 8), np.uint8), cells=2)
    >>> moved = tetwarp.deform(*mesh, kind="translate", offset=(0.25, 0, 0))
    >>> field = displacement_field(*mesh, moved, shape=(8, 8, 8))
    >>> field.values[4, 4, 4]
    array([-0.25,  0.  ,  0.  ], dtype=float32)
    """
    if convention not in _CONVENTIONS:
        raise ValueError(f"convention: expected resampling or modeling, got {convention!r}")
    grid = grid_of(reference, shape, spacing, origin, direction, affine)
    name = _CONVENTIONS[convention]
    for given in ("outside", "falloff"):
        if given in options and name == "forward":
            raise ValueError(f'{given}: is for convention="resampling"')
    return _field(name, f"tetwarp_{name}", grid, rest, cells, deformed, options)


def jacobian_determinant(
    rest: Any,
    cells: Cells,
    deformed: Any,
    *,
    reference: Any = None,
    shape: Any = None,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    affine: Any = None,
    **options: Any,
) -> Field:
    """det F at the voxels of the deformed image, F the derivative of the deformed position by the
    rest position: volume after over volume before, negative where inverted.

    Parameters and errors as of displacement_field(). Returns a Field of shape (z, y, x).

    >>> import tetwarp
    >>> mesh = tetwarp.lattice_mesh(np.ones((8, 8, 8), np.uint8), cells=2)
    >>> jacobian_determinant(*mesh, 0.5 * mesh.points, shape=(8, 8, 8)).values[1, 1, 1]
    np.float32(0.125)
    """
    grid = grid_of(reference, shape, spacing, origin, direction, affine)
    return _field("jacobian", "tetwarp_jacobian", grid, rest, cells, deformed, options)


def strain(
    rest: Any,
    cells: Cells,
    deformed: Any,
    *,
    reference: Any = None,
    shape: Any = None,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    affine: Any = None,
    **options: Any,
) -> Field:
    """Green-Lagrange strain (F^T F - I) / 2 at the voxels of the deformed image.

    Parameters and errors as of displacement_field(). Returns a Field of shape (z, y, x, 6):
    XX YY ZZ XY YZ XZ in world axes.

    >>> import tetwarp
    >>> mesh = tetwarp.lattice_mesh(np.ones((8, 8, 8), np.uint8), cells=2)
    >>> strain(*mesh, 0.5 * mesh.points, shape=(8, 8, 8)).values[1, 1, 1, :3]
    array([-0.375, -0.375, -0.375], dtype=float32)
    """
    grid = grid_of(reference, shape, spacing, origin, direction, affine)
    return _field("strain", "tetwarp_strain", grid, rest, cells, deformed, options)


def rasterize(
    points: Any,
    cells: Cells,
    *,
    reference: Any = None,
    shape: Any = None,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    affine: Any = None,
    fractions: bool = False,
    **options: Any,
) -> np.ndarray:
    """Which cell owns each voxel: the lowest-numbered one whose closed shape contains its center; or
    how much of each voxel cells fill.

    Parameters
    ----------
    points : (n, 3) node positions [world]
    cells : (m, 4) or (m, 10), (k, 8), or a pair of both, numbered tetrahedra first; faces of
        tetrahedra of ten nodes count as straight
    reference, shape, spacing, origin, direction, affine : the grid, as of displacement_field()
    fractions : True: the volume that cells share with the box of each voxel, over that of the box.
        It is exact but for rounding; where cells overlap, each one counts, so that numbers above 1
        show it. Not of tetrahedra of ten nodes
    options : backend, device, threads, as of Warper

    Returns
    -------
    (z, y, x) int32, -1 where no cell covers the voxel; with `fractions` float64

    >>> import tetwarp
    >>> tet = [(0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 3)]
    >>> int((rasterize(tet, [(0, 1, 2, 3)], shape=(4, 4, 4)) == 0).sum())
    20
    >>> round(float(rasterize(tet, [(0, 1, 2, 3)], shape=(4, 4, 4), fractions=True).sum()), 6)
    4.5
    """
    grid = grid_of(reference, shape, spacing, origin, direction, affine)
    nodes = nodes_of(points, "points")
    if flag_of(fractions, "fractions"):
        _check_options(options)
        ones = Volume(np.ones(grid.shape), grid)
        straight = cells_of(cells, "cells", len(nodes))
        with Warper(ones, nodes, straight, intensity="conservative", **options) as warper:
            return warper(nodes).volume
    return _outputs_on(grid, nodes, cells, nodes, ("owner",), options).extras["owner"]


def transform_points(
    points: Any,
    rest: Any,
    cells: Cells,
    deformed: Any,
    *,
    inverse: bool = False,
    default_value: float = np.nan,
    reference: Any = None,
    return_owners: bool = False,
) -> Any:
    """Moves points with the cells that hold them.

    The owner of a point is the lowest-numbered cell whose closed shape contains it, decided
    in exact integers after positions are rounded to 2^-20 voxel of a grid, as in a warp: with the
    grid of a warp, ``inverse=True`` gives voxel centers the owners of that warp.

    Parameters
    ----------
    points : (k, 3), in the rest mesh, or with `inverse` in the deformed one [world]
    rest, deformed : (n, 3) node positions before and after [world]
    cells : (m, 4) or (m, 10), (k, 8), or a pair of both, numbered tetrahedra first
    inverse : False: from rest to deformed; True: back
    default_value : of all three numbers of points that no cell holds
    reference : grid whose voxels set the rounding; None: at most
        2^-36 of the longest side of the mesh
    return_owners : also return the owners, (k,) int32, -1: none

    Returns
    -------
    (k, 3) float64, or a pair with the owners; arrays of the library of `points`

    Warns
    -----
    RuntimeWarning
        how many points are mapped by the straight tetrahedron of their cell, whose curved map has no
        inverse there.

    Raises
    ------
    ValueError
        naming the argument

    >>> tet = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1.0)])
    >>> transform_points([(0.25, 0.25, 0.25)], tet, [(0, 1, 2, 3)], 2 * tet)
    array([[0.5, 0.5, 0.5]])
    """
    where, with_owners = points_of(points, "points"), flag_of(return_owners, "return_owners")
    start = nodes_of(rest, "rest")
    end = nodes_of(deformed, "deformed", len(start))
    parts = curved_cells_of(cells, "cells", len(start))
    grid = None if reference is None else reference_grid(reference)._core()
    moved, owners, straightened = _core.map_points(where, grid, start, *parts, end,
                                                 flag_of(inverse, "inverse"))
    if straightened:
        warn(f"{straightened} of {len(where)} points are mapped by the straight tetrahedron of their "
             "cell, whose curved map has no inverse there")
    moved[owners < 0] = number_of(default_value, "default_value")
    make = maker_of(points)
    return (make(moved), make(owners)) if with_owners else make(moved)
