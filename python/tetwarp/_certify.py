"""Proofs that moving surfaces do not intersect, or that they do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, Sequence

import numpy as np

from . import _core
from ._arrays import nodes_of, points_of, triangles_of
from ._values import flag_of, integer_of, list_of


@dataclass(eq=False)
class Certificate:
    """What `certify` has proved.

    verdict : ``"free"``: no two triangles have a point in common at any time; ``"meets"``: some
        have; ``"undecided"``: some come nearer than rounding for a moment
    surfaces, triangles : (n, 2) int32, the pairs of triangles that meet or are undecided
    times : (n, 2) between 0 and 1: the pair does not meet before the first; where `meets`, it does
        at the second
    meets : (n,) bool, False: undecided
    near_pairs : pairs of triangles that were examined
    """

    verdict: str
    surfaces: np.ndarray
    triangles: np.ndarray
    times: np.ndarray
    meets: np.ndarray
    near_pairs: int

    def __bool__(self) -> bool:
        return self.verdict == "free"

    def __repr__(self) -> str:
        pairs = f", {len(self.meets)} pairs" if len(self.meets) else ""
        first = f", the first by time {self.times[:, 1].min():.9f}" if len(self.meets) else ""
        return f"Certificate({self.verdict}{pairs}{first}; {self.near_pairs} near pairs)"


def certify(
    surfaces: Sequence[tuple[Any, Any, Any]],
    *,
    self_intersections: bool = True,
    most_intervals: int = 1 << 14,
    threads: int = 0,
) -> Certificate:
    """Proves whether moving triangle meshes intersect: at the start, at the end or on the way.

    Every point moves straight from its place at the start to that at the end. The verdict is exact:
    rounding is bounded where triangles are proved to be apart, and meetings are decided in exact
    integers. It holds for the output of any simulation.

    Parameters
    ----------
    surfaces : per surface (start, end, triangles): (n, 3) positions, as many at the end, and (m, 3)
        integers
    self_intersections : also of triangles of one surface that share no point of it
    most_intervals : parts of time that are examined for a pair, then it is undecided
    threads : 0: all processors; any number gives the same result

    Returns
    -------
    Certificate, true where the surfaces are free

    Raises
    ------
    ValueError
        naming the argument that is wrong and what it should be.

    >>> triangle = np.array([(0, 0, 0), (4, 0, 0), (0, 4, 0)], float)
    >>> needle = np.array([(1, 1, 1), (1, 1, 2), (1.5, 1, 2)])
    >>> faces = np.array([(0, 1, 2)])
    >>> certify([(triangle, triangle, faces), (needle, needle - (0, 0, 4), faces)])
    Certificate(meets, 1 pairs, the first by time 0.250000000; 1 near pairs)
    """
    starts, ends, triangles = [], [], []
    for number, surface in enumerate(list_of(surfaces, "surfaces", "a list of surfaces")):
        name = f"surfaces[{number}]"
        if not isinstance(surface, (tuple, list)) or len(surface) != 3:
            raise ValueError(f"{name}: expected (start, end, triangles)")
        starts.append(points_of(surface[0], f"{name}: start"))
        ends.append(points_of(surface[1], f"{name}: end", len(starts[-1])))
        triangles.append(triangles_of(surface[2], f"{name}: triangles", len(starts[-1])))
    found = _core.certify(
        starts, ends, triangles, self=flag_of(self_intersections, "self_intersections"),
        most_intervals=integer_of(most_intervals, "most_intervals", 2**63 - 1),
        threads=integer_of(threads, "threads"),
    )
    return Certificate(**(found | {"meets": found["meets"].view(bool)}))


class Collisions(NamedTuple):
    """Pairs of triangles that intersect, sorted.

    surfaces : (n, 2) int32, numbers of the two surfaces, the lower one first
    triangles : (n, 2) int32, numbers of the triangles in them
    """

    surfaces: np.ndarray
    triangles: np.ndarray

    def __repr__(self) -> str:
        return f"Collisions({len(self.triangles)} pairs of triangles)"


def find_collisions(
    surfaces: Sequence[tuple[Any, Any]],
    *,
    self_intersections: bool = True,
    threads: int = 0,
) -> Collisions:
    """The pairs of triangles of surfaces at rest that have a point in common, decided exactly.

    Parameters
    ----------
    surfaces : per surface (points, triangles), a Surface: (n, 3) positions and (m, 3) integers
    self_intersections : also of triangles of one surface that share no point of it
    threads : 0: all processors

    Raises
    ------
    ValueError
        naming the argument that is wrong and what it should be.

    >>> corners = np.array([(0, 0, 0), (4, 0, 0), (0, 4, 0)], float)
    >>> faces = np.array([(0, 1, 2)])
    >>> find_collisions([(corners, faces), (corners + (1, 1, 0), faces)]).surfaces.tolist()
    [[0, 1]]
    """
    still = []
    for number, surface in enumerate(list_of(surfaces, "surfaces", "a list of surfaces")):
        if not isinstance(surface, (tuple, list)) or len(surface) != 2:
            raise ValueError(f"surfaces[{number}]: expected (points, triangles)")
        points = nodes_of(surface[0], f"surfaces[{number}]: points")
        still.append((points, points, surface[1]))
    found = certify(still, self_intersections=self_intersections, threads=threads)
    return Collisions(found.surfaces, found.triangles)
