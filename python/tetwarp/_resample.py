"""Volumes resampled by affine transforms and displacement fields."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np

from . import _core
from ._arrays import floats_of, outs_of, renamed
from ._fields import Field
from ._grid import reference_grid
from ._sources import default_value_of, gaussian_of, sources_of, warn_of_rounding
from ._values import check_callback, flag_of, integer_of, word_of
from ._volume import Volume, made_volume
from ._warper import RENAMED


def matrix_of(value: Any, name: str) -> np.ndarray:
    matrix = floats_of(value, name)
    if matrix.shape != (4, 4):
        raise ValueError(f"{name}: expected a Field of displacements, or 4 x 4 numbers, "
                         f"got shape {matrix.shape}")
    if matrix[3].tolist() != [0, 0, 0, 1]:
        raise ValueError(f"{name}: expected 0 0 0 1 as the last row, got "
                         + " ".join(f"{number:.15g}" for number in matrix[3]))
    if not np.isfinite(matrix).all():
        raise ValueError(f"{name}: a number of the matrix is not finite")
    return matrix


def link_of(value: Any, name: str) -> Any:
    """A transform as the library takes it: a matrix, or a grid and displacements on it."""
    if not isinstance(value, (Field, Volume)):
        return matrix_of(value, name)
    if value.name == "tetwarp_forward":
        raise ValueError(f'{name}: a field of convention="modeling" leads from the source to the '
                         'output; use convention="resampling" or tetwarp.invert(field)')
    return displacements_of(value, name)


def displacements_of(value: Field | Volume, name: str) -> tuple[Any, np.ndarray]:
    """A field as the library takes it: a grid and displacements on it."""
    samples = value.values if isinstance(value, Field) else value.array
    volume = made_volume(name, samples, value.grid)
    if volume.shape[3:] != (3,):
        raise ValueError(f"{name}: expected displacements, (z, y, x, 3), got {volume.shape}")
    return volume.grid._core(), np.ascontiguousarray(volume.array, np.float32)


def _is_link(value: Any) -> bool:
    if isinstance(value, (Field, Volume)):
        return True
    try:
        return np.ndim(value) == 2
    except ValueError:  # rows of several lengths, which matrix_of() refuses by name
        return True


def _links_of(transform: Any) -> list[Any]:
    """Transforms one after the other; a list of four rows of numbers is a matrix."""
    if not (isinstance(transform, (list, tuple)) and any(map(_is_link, transform))):
        return [link_of(transform, "transform")]
    return [link_of(one, f"transform[{number}]") for number, one in enumerate(transform)]


def resample(
    volume: Any,
    transform: Any,
    *,
    spacing: Any = None,
    origin: Any = None,
    direction: Any = None,
    affine: Any = None,
    interpolator: str = "linear",
    label_rule: str = "linear",
    label_gaussian: tuple[float, float] = (1.0, 1.0),
    default_value: float = 0.0,
    only_in_field: bool = False,
    reference: Any = None,
    overshoot: str = "keep",
    out: Any = None,
    threads: int = 0,
    progress: Callable[[float], Any] | None = None,
) -> Any:
    """Resamples a volume: a voxel of the output at x gets the sample of the source at transform(x),
    interpolated as by `warp`.

    Parameters
    ----------
    volume : Volume, or samples of shape (z, y, x) or (z, y, x, c) as of `warp`, in memory of the host;
        or a list of these on one grid
    transform : leads from the output to the source: a 4 x 4 matrix [world]; a Field of
        ``displacement_field``, or a Volume of three components, x y z [world], which moves nothing
        beyond its grid, both read as float32; or a list of these, of which the first one moves x first
    spacing, origin, direction, affine : of the grid of an array, see Grid
    interpolator, label_rule, label_gaussian, overshoot : as of Warper; no label_rule ``"volume"``
    default_value : of voxels whose place is beyond the source
    only_in_field : True: also of those that a displacement field does not reach
    reference : Grid of the output, or something that has one; None: that of the source
    out : array to write to, of the shape and type of the output, in C order; for several volumes a
        list of them
    threads : 0: all processors; any number gives the same bits
    progress : called with the finished fraction; False ends the call

    Returns
    -------
    Volume on the grid of the output, or a list of them

    Raises
    ------
    ValueError
        naming the argument that is wrong and what it should be.
    Cancelled
        `progress` returned False. Ctrl-C raises KeyboardInterrupt.

    >>> import tetwarp
    >>> moved = np.array([(1, 0, 0, 2), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)])
    >>> ramp = np.arange(6, dtype=np.float32).reshape(1, 1, 6)
    >>> resample(ramp, moved, default_value=-1).array.ravel().tolist()
    [2.0, 3.0, 4.0, 5.0, -1.0, -1.0]
    """
    links = _links_of(transform)
    sources = sources_of(volume, spacing, origin, direction, affine)
    arrays = [source.array for source in sources]
    grid = sources[0].grid if reference is None else reference_grid(reference)
    shapes = [grid.shape + array.shape[3:] for array in arrays]
    if out is None:
        outputs = [np.empty(shape, array.dtype) for shape, array in zip(shapes, arrays)]
    else:
        outputs = outs_of(out, shapes, arrays)
    background = default_value_of(default_value, arrays)
    words = {name: word_of(word, name) for name, word in (
        ("interpolator", interpolator), ("label_rule", label_rule), ("overshoot", overshoot))}
    options = {**words, "label_gaussian": gaussian_of(label_gaussian, label_rule),
               "default_value": background, "only_in_field": flag_of(only_in_field, "only_in_field"),
               "threads": integer_of(threads, "threads")}
    check_callback(progress, "progress")
    try:
        _core.resample(arrays, sources[0].grid._core(), links, outputs, options,
                       None if reference is None else grid._core(), progress)
    except ValueError as error:
        raise renamed(error, RENAMED) from None
    if background:
        warn_of_rounding(background, arrays)
    results = [Volume(array, grid, source.name, source.nifti)
               for array, source in zip(outputs, sources)]
    return results if isinstance(volume, (list, tuple)) else results[0]
