"""The warp of a volume by a deformed mesh."""

from __future__ import annotations

from typing import Any, Sequence

from ._mesh import Cells
from ._result import WarpResult
from ._warper import Progress, Warper


def warp(
    volume: Any,
    rest: Any,
    cells: Cells,
    deformed: Any,
    *,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    affine: Any = None,
    interpolator: str = "linear",
    default_value: float = 0.0,
    reference: Any = None,
    out: Any = None,
    outputs: Sequence[str] = (),
    progress: Progress | None = None,
    **options: Any,
) -> WarpResult:
    """Deforms a volume by a mesh: every voxel of the output gets the sample of the source at the
    rest position of the material that the deformed mesh has moved to the voxel's center.

    Parameters
    ----------
    volume : Volume, or samples of shape (z, y, x) or (z, y, x, c), of 8- to 64-bit integers,
        float32 or float64; or a list of these on one grid
    rest, deformed : (n, 3) node positions before and after, x y z [world]
    cells : (m, 4) or (m, 10) tetrahedra, (k, 8) hexahedra, or a pair of both; integers
    spacing, origin, direction, affine : of the grid of arrays, see Grid; default 1, 0, unit
    interpolator : ``"linear"``, ``"nearest"``, ``"cubic"``, ``"bspline"``, ``"lanczos"`` or
        ``"labels"``
    default_value : of voxels that no cell covers
    reference : Grid of the output, or something that has one; None: the grid of the source
    out, outputs, progress : see Warper.__call__
    options : the other keywords of Warper: label_rule, label_gaussian, outside, falloff, overshoot,
        antialias, intensity, quantity, backend, device, threads

    Returns
    -------
    WarpResult with `.volume`, `.grid`, `.report`, and the arrays of `outputs`

    Raises
    ------
    ValueError
        naming the argument that is wrong and what it should be.
    Cancelled
        `progress` returned False. Ctrl-C raises KeyboardInterrupt.

    For several steps a Warper is faster.

    >>> import tetwarp
    >>> volume = tetwarp.phantom(shape=(20, 24, 32))
    >>> mesh = tetwarp.lattice_mesh(volume, cells=3)
    >>> twisted = tetwarp.deform(*mesh, kind="twist", amount=0.5)
    >>> tetwarp.warp(volume, *mesh, twisted, outputs=("mask",)).mask.dtype
    dtype('uint8')
    """
    with Warper(
        volume, rest, cells, spacing=spacing, origin=origin, direction=direction, affine=affine,
        interpolator=interpolator, default_value=default_value, reference=reference, **options,
    ) as warper:
        return warper(deformed, out=out, outputs=outputs, progress=progress)
