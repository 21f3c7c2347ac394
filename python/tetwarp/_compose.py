"""Inverses of meshes, fields and matrices, and several of these joined to one field."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Callable, Iterator, Sequence

import numpy as np

from . import _core
from ._arrays import curved_cells_of, nodes_of
from ._fields import Field, grid_of
from ._grid import Grid, reference_grid
from ._mesh import Cells, joined_cells
from ._resample import displacements_of, link_of, matrix_of
from ._values import check_callback, flag_of, integer_of, list_of, warn
from ._volume import Volume

_ORDERS = ("image", "points")


@dataclass(eq=False)
class InverseMesh:
    """A mesh with rest and deformed positions exchanged, which is the exact inverse where the
    deformation does not fold: ``tetwarp.warp(volume, *inverse)``.

    rest, deformed : (n, 3) float64 [world]
    cells : as of Mesh
    inverted : tetrahedra of negative volume, of hexahedra their parts
    points : nodes and centers of cells that were moved there and back, of curved cells also the
        centers of their faces
    folded : of these, came back elsewhere by another cell: there the inverse is that of the cell of
        the lowest number
    largest_error : of those that are neither `folded` nor `beside`, how far from their place they
        came back [world]
    beside, beside_error : came back by a curved cell beside their own, and the largest error of these
    """

    rest: np.ndarray
    cells: Cells
    deformed: np.ndarray
    inverted: int
    points: int
    folded: int
    largest_error: float
    beside: int
    beside_error: float

    def __iter__(self) -> Iterator[Any]:
        return iter((self.rest, self.cells, self.deformed))

    def __repr__(self) -> str:
        beside = f", {self.beside} at curved faces within {self.beside_error:.3g}" if self.beside else ""
        return (f"InverseMesh({len(self.rest)} nodes, {self.points} points there and back within "
                f"{self.largest_error:.3g}{beside}; {self.folded} folded, {self.inverted} inverted)")


@dataclass(eq=False)
class ComposedField(Field):
    """Displacements as of `displacement_field` with ``convention="resampling"``. `mask` is where no
    transform was without an answer; elsewhere positions kept their place in that transform.

    outside : times that a position was in no cell of a mesh
    not_inverted : times that a position has no inverse, since the field takes nothing there
    largest_residual : of all inverses of fields, of ``|x + u(x) - y|`` [world]
    """

    outside: int = field(default=0)
    not_inverted: int = field(default=0)
    largest_residual: float = field(default=0.0)

    def __repr__(self) -> str:
        return (f"ComposedField({self.values.shape}, {self.mask.mean():.1%} reached, "
                f"{self.not_inverted} without an inverse, residual {self.largest_residual:.2g})")


def _mesh_link(rest: Any, cells: Any, deformed: Any, where: str = "") -> tuple[Any, ...]:
    """Nodes at rest, tetrahedra, hexahedra, nodes on edges and deformed nodes."""
    start = nodes_of(rest, f"{where}rest")
    return (start, *curved_cells_of(cells, f"{where}cells", len(start)),
            nodes_of(deformed, f"{where}deformed", len(start)))


def _inverse_matrix(value: Any, name: str) -> np.ndarray:
    matrix = matrix_of(value, name)
    try:
        return np.asarray(_core.inverse_matrix(matrix))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _finite(link: tuple[Any, np.ndarray], name: str) -> tuple[Any, np.ndarray]:
    if not np.isfinite(link[1]).all():
        raise ValueError(f"{name}: a displacement is not finite; set such ones to 0 first")
    return link


def _compose_link(value: Any, name: str, is_inverse: bool) -> tuple[Any, bool]:
    """A transform as the library takes it, and whether its inverse is meant."""
    if isinstance(value, InverseMesh) or (isinstance(value, (tuple, list)) and len(value) == 3):
        rest, cells, deformed = value
        return _mesh_link(rest, cells, deformed, f"{name}: "), is_inverse
    if not is_inverse:
        link = link_of(value, name)
        return _finite(link, name) if isinstance(link, tuple) else link, False
    if isinstance(value, (Field, Volume)):  # of either convention
        return _finite(displacements_of(value, name), name), True
    return _inverse_matrix(value, name), False


def _composed(links: Sequence[tuple[Any, bool]], grid: Grid, threads: int,
              progress: Callable[[float], Any] | None) -> ComposedField:
    check_callback(progress, "progress")
    values, reached, outside, straightened, not_inverted, residual = _core.compose(
        links, grid._core(), integer_of(threads, "threads"), progress)
    if straightened:
        warn(f"{straightened} times a position was mapped by the straight tetrahedron of its cell, "
             "whose curved map has no inverse there")
    if not_inverted:
        warn(f"{not_inverted} of {reached.size} positions have no inverse: the field takes nothing "
             "there; they kept their place, and mask is False")
    return ComposedField(values, reached.reshape(grid.shape).view(bool), grid, "tetwarp_displacement",
                         outside, not_inverted, residual)


def compose(
    transforms: Sequence[Any],
    *,
    order: str,
    inverse: Sequence[bool] | None = None,
    reference: Any = None,
    shape: Any = None,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    affine: Any = None,
    threads: int = 0,
    progress: Callable[[float], Any] | None = None,
) -> ComposedField:
    """Joins meshes, fields and matrices to one field, so that `resample` interpolates a volume once.

    Parameters
    ----------
    transforms : each one ``(rest, cells, deformed)`` as of `warp`, also what `invert` returns; a
        Field of displacements or a Volume of three components, which move nothing beyond their grid;
        or a 4 x 4 matrix. Fields and matrices lead from the output to the source, as of `resample`
    order : ``"image"``: the first one is applied to the image first, then the second one to the
        result, as in `tetwarp compose`; ``"points"``: the first one moves positions of the output
        first, as in the list of `resample`, which is the reverse
    inverse : per transform, True: its inverse, of a field as by `invert`; None: of none
    reference, shape, spacing, origin, direction, affine : grid of the field, as of
        displacement_field()
    threads : 0: all processors; any number gives the same bits
    progress : called with the finished fraction; False ends the call

    Returns
    -------
    ComposedField of shape (z, y, x, 3). Positions that no cell of a mesh holds keep their place there

    Warns
    -----
    RuntimeWarning
        how many positions have no inverse in a field.

    Raises
    ------
    ValueError
        naming the argument that is wrong and what it should be.
    Cancelled
        `progress` returned False. Ctrl-C raises KeyboardInterrupt.

    >>> turn = np.array([(0, -1, 0, 3), (1, 0, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)])
    >>> shift = np.array([(1, 0, 0, 1), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)])
    >>> compose([turn, shift], order="points", shape=(1, 4, 4)).values[0, 2, 1]
    array([ 1., -1.,  0.], dtype=float32)
    >>> compose([turn, shift], order="image", shape=(1, 4, 4)).values[0, 2, 1]
    array([0., 0., 0.], dtype=float32)
    """
    if order not in _ORDERS:
        raise ValueError(f"order: expected image or points, got {order!r}")
    grid = grid_of(reference, shape, spacing, origin, direction, affine)
    given = list_of(transforms, "transforms", "a list of transforms")
    if not given:
        raise ValueError("transforms: expected at least one transform")
    flags = [False] * len(given) if inverse is None else [
        flag_of(flag, f"inverse[{number}]")
        for number, flag in enumerate(list_of(inverse, "inverse", "a flag per transform"))]
    if len(flags) != len(given):
        raise ValueError(f"inverse: expected {len(given)} flags, one per transform, got {len(flags)}")
    links = [_compose_link(one, f"transforms[{number}]", flag)
             for number, (one, flag) in enumerate(zip(given, flags))]
    return _composed(links[::-1] if order == "image" else links, grid, threads, progress)


def _inverse_mesh(rest: Any, cells: Any, deformed: Any) -> InverseMesh:
    start, tets, hexes, mids, end = _mesh_link(rest, cells, deformed)
    check = _core.check_inverse(start, tets, hexes, mids, end)
    straightened = check.pop("straightened")
    if straightened:
        warn(f"{straightened} of {check['points']} points are mapped by the straight tetrahedron of "
             "their cell, whose curved map has no inverse there")
    if check["inverted"] or check["folded"]:
        warn(f"deformed: folds: {check['inverted']} inverted tetrahedra, {check['folded']} of "
             f"{check['points']} points come back to another place; there the inverse is that of the "
             "cell of the lowest number")
    return InverseMesh(end.copy(), joined_cells(tets, hexes, mids), start.copy(), **check)


def invert(
    transform: Any,
    cells: Cells = None,
    deformed: Any = None,
    *,
    reference: Any = None,
    threads: int = 0,
    progress: Callable[[float], Any] | None = None,
) -> Any:
    """The inverse of the deformation of a mesh, of a field, or of a matrix.

    Parameters
    ----------
    transform : nodes at rest, (n, 3), followed by `cells` and `deformed` as of `warp`; or a Field of
        displacements, of either convention, or a Volume of three components; or a 4 x 4 matrix
    reference : of a field: grid of its inverse, or something that has one; None: its own
    threads, progress : of a field: 0: all processors; called with the finished fraction, False ends
        the call

    Returns
    -------
    of a mesh: an InverseMesh, which is exact and tells folds and the error of a round trip;
    of a field: a ComposedField of displacements v with ``|x + u(x) - y| <= 1e-6`` of the smallest
    spacing for ``x = y + v(y)``, by Newton's method from several starts; its `mask` is False and v
    is 0 where the field takes nothing; of a matrix: (4, 4) float64

    Warns
    -----
    RuntimeWarning
        the deformation folds, or a field has no inverse at some voxels.

    Raises
    ------
    ValueError
        naming the argument that is wrong and what it should be.

    >>> import tetwarp
    >>> mesh = tetwarp.lattice_mesh(np.ones((8, 8, 8), np.uint8), cells=2)
    >>> moved = tetwarp.deform(*mesh, kind="bend", amount=0.2)
    >>> inverse = invert(*mesh, moved)
    >>> inverse.folded, inverse.inverted, inverse.largest_error < 1e-12
    (0, 0, True)
    >>> field = tetwarp.displacement_field(*mesh, moved, shape=(8, 8, 8), outside="nearest")
    >>> invert(field).largest_residual <= 1e-6
    True
    """
    if deformed is not None or cells is not None:
        if reference is not None:
            raise ValueError("reference: is for fields; the inverse of a mesh is a mesh")
        return _inverse_mesh(transform, cells, deformed)
    if isinstance(transform, (Field, Volume)):
        link = _finite(displacements_of(transform, "transform"), "transform")
        grid = reference_grid(transform if reference is None else reference)
        return _composed([(link, True)], grid, threads, progress)
    if reference is not None:
        raise ValueError("reference: is for fields; the inverse of a matrix is a matrix")
    return _inverse_matrix(transform, "transform")
