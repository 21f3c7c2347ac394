"""The warp as a linear operator: its transpose, and its derivatives by positions of nodes."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core
from ._arrays import (
    array_of,
    cells_of,
    describe,
    floats_of,
    is_foreign,
    maker_of,
    nodes_of,
    out_of,
    renamed,
)
from ._grid import Grid, make_grid, reference_grid
from ._mesh import Cells
from ._values import integer_of, word_of

_NO_MASK = np.empty(0, np.uint8)


def _source_grid(source: Any, spacing: Any, origin: Any, direction: Any, affine: Any) -> Grid:
    """The grid of a Grid, of what has one, or of an array with the usual keywords."""
    if isinstance(source, (np.ndarray, list, tuple)) or is_foreign(source):
        array: Any = source if is_foreign(source) else array_of(source, "source")
        shape = tuple(array.shape)
        if len(shape) not in (3, 4):
            raise ValueError(f"source: expected shape (z, y, x) or (z, y, x, c), got {shape}")
        return make_grid(shape[:3], spacing, origin, direction, affine)
    if any(x is not None for x in (spacing, origin, direction, affine)):
        raise ValueError("source: it has a grid; leave out spacing, origin, direction and affine")
    return reference_grid(source, "source")


class WarpOperator:
    """The matrix W of one deformation: ``W x`` are the samples that `warp` gives of the samples x,
    in float64 and with 0 where no cell is. It is not stored, but see `intensity`.

    `forward` and `adjoint` use the same weights, and take every sum in one order: results have the
    same bits for any number of threads. SciPy takes the operator wherever it takes a
    `LinearOperator`: ``scipy.sparse.linalg.lsqr(operator, y.ravel())``.

    Parameters
    ----------
    source : grid of the samples x: a Grid, a Volume, an image, or an array of shape (z, y, x) with
        the keywords spacing, origin, direction or affine (see Grid)
    rest, deformed : (n, 3) node positions before and after, x y z [world]
    cells : (m, 4) tetrahedra, (m, 8) hexahedra, or a pair of both; integers
    interpolator : ``"linear"``, ``"nearest"``, ``"cubic"``, ``"bspline"`` or ``"lanczos"``
    outside : ``"background"``: rows of voxels that no cell covers are zero; ``"identity"``: they
        take the source at the same position
    intensity : ``"value"``; or ``"conservative"``: rows hold what the cells move into the box of an
        output voxel from the boxes of voxels of the source, over its volume, so that totals are
        kept. It does not use `interpolator`, and stores W, 16 bytes per pair of such voxels
    reference : Grid of the output, or something that has one; None: that of the source
    mask : bool of the shape of the output; rows of voxels where it is False are zero
    threads : 0: all processors

    Raises
    ------
    ValueError
        naming the argument that is wrong and what it should be.

    >>> import tetwarp
    >>> volume = tetwarp.phantom(shape=(20, 24, 32))
    >>> mesh = tetwarp.lattice_mesh(volume, cells=3)
    >>> W = WarpOperator(volume, *mesh, tetwarp.deform(*mesh, kind="twist", amount=0.5))
    >>> x = volume.array.astype(float)
    >>> y = W.forward(x)
    >>> bool(np.isclose(np.vdot(y, y), np.vdot(x, W.adjoint(y)), rtol=1e-13))
    True
    """

    dtype = np.dtype(np.float64)

    def __init__(
        self,
        source: Any,
        rest: Any,
        cells: Cells,
        deformed: Any,
        *,
        spacing: Any = None,
        origin: Any = None,
        direction: Any = None,
        affine: Any = None,
        interpolator: str = "linear",
        outside: str = "background",
        intensity: str = "value",
        reference: Any = None,
        mask: Any = None,
        threads: int = 0,
    ) -> None:
        self._source = _source_grid(source, spacing, origin, direction, affine)
        self._output = self._source if reference is None else reference_grid(reference)
        points = nodes_of(rest, "rest")
        try:
            self._core = _core.WarpOperator(
                self._source._core(), points, *cells_of(cells, "cells", len(points)),
                nodes_of(deformed, "deformed", len(points)),
                interpolator=word_of(interpolator, "interpolator"),
                intensity=word_of(intensity, "intensity"), outside=word_of(outside, "outside"),
                output_grid=self._output._core(), mask=self._mask_of(mask),
                threads=integer_of(threads, "threads"),
            )
        except ValueError as error:
            raise renamed(error, {"filter": "interpolator"}) from None

    def _mask_of(self, mask: Any) -> np.ndarray:
        if mask is None:
            return _NO_MASK
        array = array_of(mask, "mask")
        if array.shape != self._output.shape or array.dtype.kind not in "biu":
            raise ValueError(
                f"mask: expected bool of shape {self._output.shape}, got {describe(array)}"
            )
        return np.ascontiguousarray(array != 0).view(np.uint8)

    @property
    def source_grid(self) -> Grid:
        """Grid of the samples x."""
        return self._source

    @property
    def grid(self) -> Grid:
        """Grid of the output."""
        return self._output

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of W: voxels of the output and of the source."""
        return int(np.prod(self._output.shape)), int(np.prod(self._source.shape))

    @property
    def support(self) -> np.ndarray:
        """Bool of the shape of the output: rows of W that are not zero."""
        return self._core.support().view(bool).reshape(self._output.shape)

    def __repr__(self) -> str:
        rows, columns = self.shape
        return f"WarpOperator({rows} x {columns}, {self._source.shape} to {self._output.shape})"

    def forward(self, x: Any, *, out: Any = None) -> np.ndarray:
        """``W x``.

        x : numbers of shape (z, y, x) or (z, y, x, c) of the source; read in place if float64 in
            C order
        out : float64 array to write to, of the shape of the result; None: a new one

        Returns samples on `grid`; every component is mapped by the same W.
        """
        return self._apply(self._core.forward, x, "x", self._source, self._output, out)

    def adjoint(self, y: Any, *, out: Any = None) -> np.ndarray:
        """``W.T y``: samples on `source_grid` from numbers of the shape of the output; otherwise as
        `forward`.
        """
        return self._apply(self._core.adjoint, y, "y", self._output, self._source, out)

    def matvec(self, x: Any) -> np.ndarray:
        """``W x`` of flat arrays, for SciPy."""
        return self.forward(array_of(x, "x").reshape(self._source.shape)).reshape(-1)

    def rmatvec(self, y: Any) -> np.ndarray:
        """``W.T y`` of flat arrays, for SciPy."""
        return self.adjoint(array_of(y, "y").reshape(self._output.shape)).reshape(-1)

    def node_gradient(self, x: Any, y: Any) -> np.ndarray:
        """The derivative of ``sum(y * W x)`` by `deformed`, shape (n, 3), with the owners of voxels
        held fixed: what nodes move within cells, not what they uncover at the surface of the mesh.

        For a misfit of ``W x`` to data pass its derivative by ``W x`` as y: of ``0.5 * sum((W x -
        data)**2)`` this is ``W x - data``. There is none for intensity ``"conservative"``.

        >>> import tetwarp
        >>> rest, cells = tetwarp.lattice_mesh(tetwarp.phantom(shape=(8, 9, 10)), cells=2)
        >>> volume = tetwarp.phantom(shape=(8, 9, 10))
        >>> W = WarpOperator(volume, rest, cells, rest)
        >>> W.node_gradient(volume, W.forward(volume)).shape == rest.shape
        True
        """
        return maker_of(x)(self._core.node_gradient(
            self._numbers(x, "x", self._source), self._numbers(y, "y", self._output)
        ))

    @staticmethod
    def _numbers(value: Any, name: str, grid: Grid) -> np.ndarray:
        array = floats_of(value, name)
        if array.ndim not in (3, 4) or array.shape[:3] != grid.shape or array.size == 0:
            raise ValueError(
                f"{name}: expected shape {grid.shape}, or this and components, got {array.shape}"
            )
        return array

    def _apply(
        self, call: Any, value: Any, name: str, grid: Grid, to: Grid, out: Any
    ) -> np.ndarray:
        array = self._numbers(value, name, grid)
        shape = to.shape + array.shape[3:]
        result = np.empty(shape) if out is None else out_of(out, "out", shape, np.float64)
        if out is not None and np.may_share_memory(result, array):
            raise ValueError(f"out: shares memory with {name}")
        call(array, result)
        return maker_of(value)(result) if out is None else out
