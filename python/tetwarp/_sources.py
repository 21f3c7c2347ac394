"""What a warp reads: volumes on one grid, what their components are, and the value beyond the mesh."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from ._arrays import pair_of
from ._device import type_of
from ._values import list_of, number_of, warn, word_of
from ._volume import Volume, volume_of


def sources_of(
    volume: Any, spacing: Any, origin: Any, direction: Any, affine: Any
) -> list[Volume]:
    """Volumes on one grid."""
    if not isinstance(volume, (list, tuple)):
        return [volume_of(volume, "volume", spacing, origin, direction, affine)]
    if not volume:
        raise ValueError("volume: expected at least one volume")
    sources = [
        volume_of(one, f"volume[{number}]", spacing, origin, direction, affine)
        for number, one in enumerate(volume)
    ]
    for number, source in enumerate(sources):
        if source.grid != sources[0].grid:
            raise ValueError(
                f"volume[{number}]: expected the grid of volume[0], {sources[0].grid}, "
                f"got {source.grid}"
            )
    return sources


def default_value_of(value: Any, sources: Sequence[Any]) -> float:
    """A number, which no source rounds: the library has it in float64."""
    number = number_of(value, "default_value")
    whole = value.item() if np.ndim(value) == 0 and hasattr(value, "item") else value
    for source in sources if isinstance(whole, int) else ():
        if type_of(source) not in ("int64", "uint64"):
            continue
        limits = np.iinfo(type_of(source))
        given = min(max(whole, limits.min), limits.max)
        if given != min(max(int(number), limits.min), limits.max):
            raise ValueError(f"default_value: expected a number that float64 holds, got {value}")
    return number


def warn_of_rounding(number: float, sources: Sequence[Any]) -> None:
    """A warning for each type of samples in which a default value is another number; none for a fraction
    in floats, which hold the nearest one, as of every sample.
    """
    for name in dict.fromkeys(map(type_of, sources)):
        if np.dtype(name).kind in "iu":
            limits = np.iinfo(name)
            kept: float = min(max(round(number), int(limits.min)), int(limits.max))
            fits = float(kept) == number
        else:
            with np.errstate(over="ignore"):
                kept = float(np.float64(number).astype(name))
            is_whole = bool(np.isfinite(number)) and number.is_integer()
            fits = kept == number if is_whole else bool(np.isfinite(kept) == np.isfinite(number))
        if not fits:
            warn(f"default_value: {number:.15g} does not fit {name}, {kept:.15g} is stored")


def gaussian_of(value: Any, label_rule: Any) -> tuple[float, float]:
    """Standard deviation and cutoff of the label rule "gaussian"; of another one the default ones only."""
    gaussian = pair_of(value, "label_gaussian")
    if gaussian != (1.0, 1.0) and label_rule != "gaussian":
        raise ValueError(
            f'label_gaussian: is for label_rule="gaussian", got label_rule={label_rule!r}')
    return gaussian


def quantities_of(quantity: Any, count: int) -> list[str]:
    """What the components of each source are, checked by number."""
    if quantity is None:
        return []
    words = [quantity] * count if isinstance(quantity, str) else list_of(quantity, "quantity", "words")
    if len(words) != count:
        raise ValueError(f"quantity: expected {count} words, one per volume, got {len(words)}")
    return [word_of(word, "quantity") for word in words]
