"""Meshes of tetrahedra and hexahedra, and surfaces of triangles."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from . import _core
from ._arrays import curved_cells_of, nodes_of, vector_of
from ._values import exact_of, flag_of, integer_of, number_of, word_of
from ._volume import volume_of

Cells = Any  # (m, 4) or (m, 10), (k, 8), or a pair of both

_AXES = {"x": 0, "y": 1, "z": 2}
#: Arguments of deform(), their values where they are not given, and the kinds that use them.
_USED = {"amount": (1.0, "twist bend swim random rotate"), "axis": ("z", "twist bend swim rotate"),
         "seed": (1, "random"), "offset": ((0.0, 0.0, 0.0), "translate")}


class Mesh(NamedTuple):
    """Nodes and cells; ``points, cells = mesh`` unpacks it.

    points : (n, 3) float64, x y z [world]
    cells : (m, 4) tetrahedra or (k, 8) hexahedra in VTK's order, int32; a pair where there are
        both. Where a tetrahedron has ten nodes, all have (m, 10): four corners, then the nodes on
        the edges 0 1, 1 2, 2 0, 0 3, 1 3 and 2 3; -1 for these where it has four
    """

    points: np.ndarray
    cells: Cells

    @property
    def cell_count(self) -> int:
        """Tetrahedra and hexahedra."""
        if isinstance(self.cells, tuple):
            return sum(len(part) for part in self.cells)
        return len(self.cells)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({len(self.points)} nodes, {self.cell_count} cells)"


class Surface(NamedTuple):
    """Triangles.

    points : (n, 3) float64, x y z [world]
    triangles : (m, 3) int32, counter-clockwise from outside
    """

    points: np.ndarray
    triangles: np.ndarray

    def __repr__(self) -> str:
        return f"Surface({len(self.points)} points, {len(self.triangles)} triangles)"


def joined_cells(tets: np.ndarray, hexes: np.ndarray, mids: np.ndarray) -> Cells:
    """Cells as a Mesh has them, from what curved_cells_of() returns."""
    if len(mids):
        tets = np.hstack([tets, mids])
    if len(hexes) == 0:
        return tets
    return hexes if len(tets) == 0 else (tets, hexes)


def lattice_mesh(
    volume: Any,
    *,
    cells: int = 8,
    threshold: float | None = None,
    hexahedra: bool = False,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    affine: Any = None,
) -> Mesh:
    """A mesh of cubes along the axes of the grid that covers the foreground of a volume.

    Parameters
    ----------
    volume : Volume, or samples of shape (z, y, x) or (z, y, x, c)
    cells : cubes along the longest side of the foreground's box, at least 1
    threshold : voxels above it are foreground; None: all voxels are
    hexahedra : True: one hexahedron per cube; False: five tetrahedra
    spacing, origin, direction, affine : of the grid of an array, see Grid

    Raises
    ------
    ValueError
        there is no foreground, or naming the argument.

    >>> lattice_mesh(np.ones((8, 8, 8), np.uint8), cells=2)
    Mesh(27 nodes, 40 cells)
    """
    source = volume_of(volume, "volume", spacing, origin, direction, affine)
    made = _core.lattice_mesh(
        source.array, source.grid._core(), integer_of(cells, "cells"),
        None if threshold is None else exact_of(threshold, "threshold"), flag_of(hexahedra, "hexahedra"),
    )
    return Mesh(*made)


def deform(
    points: Any,
    cells: Cells,
    *,
    kind: str = "twist",
    amount: float = 1.0,
    axis: str = "z",
    seed: int = 1,
    offset: Any = (0.0, 0.0, 0.0),
    time: float = 1.0,
) -> np.ndarray:
    """Node positions of a smooth deformation, for demonstrations and tests.

    Parameters
    ----------
    points : (n, 3), nodes at rest [world]
    cells : (m, 4) or (m, 10), (k, 8), or a pair of both
    kind : ``"twist"``, ``"bend"``, ``"swim"``, ``"random"``, ``"rotate"`` or ``"translate"``
    amount : quarter turns for twist, bend and rotate; relative to the mesh's box for swim and
        random
    axis : ``"x"``, ``"y"`` or ``"z"``, of twist, bend, swim and rotate
    seed : of random
    offset : (x, y, z), of translate [world]. What a kind does not use is refused
    time : 0 (at rest) to 1 (the full amount)

    Returns
    -------
    (n, 3) float64

    >>> mesh = lattice_mesh(np.ones((8, 8, 8), np.uint8), cells=2)
    >>> deform(*mesh, kind="translate", offset=(1, 0, 0))[0] - mesh.points[0]
    array([1., 0., 0.])
    """
    nodes = nodes_of(points, "points")
    tets, hexes, _ = curved_cells_of(cells, "cells", len(nodes))
    if word_of(axis, "axis") not in _AXES:
        raise ValueError(f"axis: expected x, y or z, got {axis!r}")
    seed = integer_of(seed, "seed", 2**64 - 1)
    if seed < 0:
        raise ValueError(f"seed: expected a number from 0 to 2^64 - 1, got {seed}")
    size, way = number_of(amount, "amount"), vector_of(offset, "offset")
    moved = _core.deform(nodes, tets, hexes, word_of(kind, "kind"), size, _AXES[axis], seed, way,
                         number_of(time, "time"))
    for name, value in {"amount": size, "axis": axis, "seed": seed, "offset": way}.items():
        default, kinds = _USED[name]
        if value != default and kind not in kinds.split():
            raise ValueError(f"{name}: has no effect on kind {kind!r}; leave it out")
    return np.asarray(moved)


def boundary_surface(points: Any, cells: Cells) -> Surface:
    """The triangles that only one tetrahedron of a mesh has; tetrahedra of ten nodes are split.

    >>> mesh = lattice_mesh(np.ones((8, 8, 8), np.uint8), cells=1)
    >>> boundary_surface(*mesh)
    Surface(8 points, 12 triangles)
    """
    nodes = nodes_of(points, "points")
    tets, hexes, mids = curved_cells_of(cells, "cells", len(nodes))
    return Surface(*_core.boundary_surface(nodes, _core.split_ten_nodes(tets, mids), hexes))


def split_ten_nodes(cells: Cells) -> Cells:
    """The cells with eight straight tetrahedra between its nodes in place of every tetrahedron of ten
    nodes: for what curved ones are refused. The map changes by at most a quarter of the sum of the
    distances of the six nodes from the middles of their edges.

    Parameters
    ----------
    cells : (m, 4) or (m, 10), (k, 8), or a pair of both

    >>> split_ten_nodes([range(10)])[:2]
    array([[0, 4, 6, 7],
           [4, 1, 5, 8]], dtype=int32)
    """
    tets, hexes, mids = curved_cells_of(cells, "cells", 2**31 - 1)
    return joined_cells(_core.split_ten_nodes(tets, mids), hexes, mids[:0])


def isosurface(
    volume: Any,
    value: float,
    *,
    triangles: int | None = None,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    affine: Any = None,
) -> Surface:
    """The closed surface around the samples from `value` on.

    Parameters
    ----------
    volume : Volume, or samples of shape (z, y, x)
    value : samples from it on are inside
    triangles : about how many; None: as many as there are
    spacing, origin, direction, affine : of the grid of an array, see Grid

    >>> isosurface(np.pad(np.ones((2, 2, 2)), 2), 0.5)
    Surface(60 points, 116 triangles)
    """
    source = volume_of(volume, "volume", spacing, origin, direction, affine)
    about = None if triangles is None else integer_of(triangles, "triangles", 2**63 - 1)
    made = _core.isosurface(source.array, source.grid._core(), exact_of(value, "value"), about)
    return Surface(*made)


