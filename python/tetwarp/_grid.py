"""Regular grids of voxel centers in the world."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from . import _core
from ._arrays import numbers_of, vector_of
from ._values import integer_of, is_masked

_UNIT = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_UNIT_ROWS = np.ravel(_UNIT)


def shape_of(value: Any) -> tuple[int, int, int]:
    """Voxels along z, y, x."""
    if is_masked(value):
        raise ValueError("shape: has masked elements; use .filled(value)")
    numbers = value if type(value) is tuple else np.ravel(np.asarray(value, object))
    shape: Any = tuple([integer_of(n, "shape") for n in numbers])
    if len(shape) != 3:
        raise ValueError(f"shape: expected three numbers z, y, x, got {value}")
    if min(shape) < 1 or max(shape) > 2**30:
        raise ValueError(f"shape: expected 1 to 2^30 voxels along each axis, got {shape}")
    return shape


@dataclass(frozen=True)
class Grid:
    """A regular grid of voxel centers.

    The center of voxel (i, j, k), which is element ``[k, j, i]`` of an array, is at
    ``origin + direction @ (spacing * (i, j, k))`` in the world, in length units of the caller.

    Parameters
    ----------
    shape : (z, y, x), voxels along the axes of an array
    spacing : (x, y, z), distance of centers along the grid's axes, above 0
    origin : (x, y, z), center of the first voxel
    direction : 3 x 3, its columns are the grid's axes in the world; invertible

    Raises
    ------
    ValueError
        naming the argument that is wrong.

    >>> Grid((4, 5, 6), spacing=(1, 1, 2)).affine[2]
    array([0., 0., 2., 0.])
    """

    shape: tuple[int, int, int]
    spacing: tuple[float, float, float] = (1.0, 1.0, 1.0)
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    direction: tuple[tuple[float, float, float], ...] = field(default=_UNIT)

    def __post_init__(self) -> None:
        shape = shape_of(self.shape)
        rows = _UNIT_ROWS if self.direction is _UNIT else numbers_of(self.direction, "direction")
        if rows.size != 9:
            raise ValueError(f"direction: expected 3 x 3 numbers, got {rows.size}")
        set_ = object.__setattr__  # the class is frozen
        set_(self, "shape", shape)
        set_(self, "spacing", vector_of(self.spacing, "spacing"))
        set_(self, "origin", vector_of(self.origin, "origin"))
        set_(self, "direction", tuple(map(tuple, rows.reshape(3, 3).tolist())))
        set_(self, "_made", _core.Grid(shape[::-1], self.origin, self.spacing, rows.tolist()))

    def __reduce__(self) -> Any:
        return Grid, (self.shape, self.spacing, self.origin, self.direction)

    @classmethod
    def from_affine(cls, shape: Any, affine: Any) -> Grid:
        """The grid of a 4 x 4 matrix from (i, j, k, 1) to the world, as nibabel has it.

        >>> Grid.from_affine((4, 5, 6), np.diag([2, 3, 4, 1])).spacing
        (2.0, 3.0, 4.0)
        """
        matrix = numbers_of(affine, "affine")
        if matrix.size != 16:
            raise ValueError(f"affine: expected 4 x 4 numbers, got shape {np.shape(affine)}")
        return _grid_of_affine(shape_of(shape), matrix.tobytes())

    @property
    def affine(self) -> np.ndarray:
        """4 x 4 matrix from (i, j, k, 1) to the world."""
        affine = np.eye(4)
        affine[:3, :3] = np.array(self.direction) * np.array(self.spacing)
        affine[:3, 3] = self.origin
        return affine

    def points(self) -> np.ndarray:
        """World positions of all voxel centers, shape (z, y, x, 3)."""
        k, j, i = np.meshgrid(*(np.arange(n, dtype=float) for n in self.shape), indexing="ij")
        index = np.stack([i, j, k], axis=-1) * np.array(self.spacing)
        return index @ np.array(self.direction).T + np.array(self.origin)

    def _core(self) -> _core.Grid:
        return self.__dict__["_made"]


@lru_cache(maxsize=16)  # a call of warp with an affine matrix would take half as long again
def _grid_of_affine(shape: tuple[int, int, int], matrix: bytes) -> Grid:
    *rows, last = np.frombuffer(matrix).reshape(4, 4).tolist()
    if last != [0, 0, 0, 1]:
        raise ValueError("affine: expected 0 0 0 1 as its last row")
    *axes, origin = zip(*rows)
    spacing: Any = tuple([math.sqrt(x * x + y * y + z * z) for x, y, z in axes])
    if not all(0 < length < math.inf for length in spacing):
        raise ValueError("affine: expected finite columns other than 0")
    direction: Any = tuple([(x / spacing[0], y / spacing[1], z / spacing[2]) for x, y, z, _ in rows])
    return Grid(shape, spacing, origin, direction)


def grid_from_core(grid: _core.Grid) -> Grid:
    return make_grid(grid.dims[::-1], grid.spacing, grid.origin, grid.direction, None)


def make_grid(shape: Any, spacing: Any, origin: Any, direction: Any, affine: Any) -> Grid:
    """The grid of the usual keywords: `affine`, or any of the other three."""
    if affine is not None:
        if spacing is not None or origin is not None or direction is not None:
            raise ValueError("affine: give either affine, or spacing, origin and direction")
        return Grid.from_affine(shape, affine)
    return Grid(
        shape,
        (1.0, 1.0, 1.0) if spacing is None else spacing,
        (0.0, 0.0, 0.0) if origin is None else origin,
        _UNIT if direction is None else direction,
    )


def reference_grid(reference: Any, name: str = "reference") -> Grid:
    """The grid of a Grid, of what has an attribute `grid`, or of an image of nibabel or ITK."""
    if isinstance(reference, Grid):
        return reference
    if isinstance(getattr(reference, "grid", None), Grid):
        return reference.grid
    if hasattr(reference, "affine") and hasattr(reference, "shape"):  # nibabel: axes x, y, z
        if len(reference.shape) < 3:
            raise ValueError(f"{name}: expected an image of three axes, got {reference.shape}")
        return Grid.from_affine(tuple(reference.shape[:3])[::-1], reference.affine)
    if hasattr(reference, "GetSpacing") and hasattr(reference, "GetDirection"):  # SimpleITK
        if reference.GetDimension() != 3:
            raise ValueError(f"{name}: expected an image of three dimensions, got "
                             f"{reference.GetDimension()}")
        return make_grid(
            tuple(reference.GetSize())[::-1], reference.GetSpacing(), reference.GetOrigin(),
            np.reshape(reference.GetDirection(), (3, 3)), None,
        )
    raise ValueError(
        f"{name}: expected a tetwarp.Grid, a Volume, a result of a warp, or an image of nibabel "
        f"or SimpleITK, got {type(reference).__name__}"
    )
