"""Samples and their grid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _core
from ._arrays import as_array, samples_of
from ._grid import Grid, grid_from_core, make_grid
from ._values import check_kind, word_of


@dataclass(eq=False)
class Volume:
    """Samples on a grid.

    `array` has shape (z, y, x) or (z, y, x, components); ``numpy.asarray(volume)`` is that array.
    `nifti` keeps what a NIfTI header says beside grid and samples, so that a file that is written
    says the same.

    >>> Volume(np.zeros((2, 3, 4), np.uint8), Grid((2, 3, 4)))
    Volume((2, 3, 4) of uint8, spacing (1.0, 1.0, 1.0), name 'values')
    """

    array: np.ndarray
    grid: Grid
    name: str = "values"
    nifti: dict[str, Any] | None = None

    def __post_init__(self) -> None:
        self.array = samples_of(self.array, "array")
        check_kind(self.grid, Grid, "grid")
        if self.array.shape[:3] != self.grid.shape:
            raise ValueError(
                f"array: expected {self.grid.shape} voxels as in the grid, got {self.array.shape}"
            )

    @property
    def shape(self) -> tuple[int, ...]:
        return self.array.shape

    @property
    def dtype(self) -> np.dtype:
        return self.array.dtype

    @property
    def affine(self) -> np.ndarray:
        """4 x 4 matrix from (i, j, k, 1) to the world."""
        return self.grid.affine

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return as_array(self.array, dtype, copy)

    def __repr__(self) -> str:
        spacing = tuple(round(x, 6) for x in self.grid.spacing)
        return f"Volume({self.shape} of {self.dtype}, spacing {spacing}, name {self.name!r})"


def made_volume(where: str, *members: Any) -> Volume:
    """A Volume of these members, whose errors name the argument that they are of."""
    try:
        return Volume(*members)
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None


def checked_volume(value: Any, name: str) -> Volume:
    """A Volume with the members of another one, which can be set at any time: they are checked where
    they are used.
    """
    check_kind(value, Volume, name)
    return made_volume(name, value.array, value.grid, value.name, value.nifti)


def volume_of(
    value: Any, name: str, spacing: Any, origin: Any, direction: Any, affine: Any
) -> Volume:
    """A Volume, checked, or an array with the usual keywords."""
    if isinstance(value, Volume):
        if any(x is not None for x in (spacing, origin, direction, affine)):
            raise ValueError(
                f"{name}: a Volume has a grid; leave out spacing, origin, direction and affine"
            )
        return checked_volume(value, name)
    array = samples_of(value, name)
    return Volume(array, make_grid(array.shape[:3], spacing, origin, direction, affine))


def phantom(
    kind: str = "torso", shape: Any = (122, 160, 256), *, spacing: Any = (1.0, 1.0, 1.0)
) -> Volume:
    """An image made of analytic shapes, the same for the same shape.

    Parameters
    ----------
    kind : ``"torso"`` (float32, 384 x 240 x 366 around the origin for any shape; `spacing` is not
        used), ``"orange"`` (float32) or ``"fish"`` (uint8)
    shape : (z, y, x), voxels
    spacing : (x, y, z), of orange and fish

    Raises
    ------
    ValueError
        naming the argument.

    >>> phantom(shape=(61, 80, 128))
    Volume((61, 80, 128) of float32, spacing (3.0, 3.0, 6.0), name 'torso')
    """
    wanted = Grid(shape, spacing)
    array, grid = _core.phantom(word_of(kind, "kind"), wanted.shape[::-1], wanted.spacing)
    return Volume(array, grid_from_core(grid), kind)
