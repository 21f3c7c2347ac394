"""What a warp returns."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core
from ._arrays import describe
from ._grid import Grid

#: Further outputs of a warp: name, type, components.
EXTRAS: dict[str, tuple[Any, int]] = {
    "mask": (np.uint8, 1),
    "owner": (np.int32, 1),
    "displacement": (np.float32, 3),
    "jacobian": (np.float32, 1),
    "gradient": (np.float32, 9),
    "strain": (np.float32, 6),
    "forward": (np.float32, 3),
}


class WarpResult:
    """What a warp has made.

    volume : the warped samples, (z, y, x) or (z, y, x, c), of the type of the source; a tensor or
        array of the library that the source was of
    grid : of all arrays
    report : counts of voxels and tetrahedra, seconds of the stages, totals, back end
    volumes : one array per source; `volume` is the first
    extras : the arrays of `outputs` by name, which are attributes as well: ``result.mask``
    names, nifti : per source its name and what its NIfTI header says, for files

    `write` writes it with all its arrays, as the command does.
    """

    def __init__(
        self,
        volume: np.ndarray,
        grid: Grid,
        report: _core.StepReport,
        volumes: tuple[np.ndarray, ...],
        extras: dict[str, np.ndarray],
        names: tuple[str, ...],
        nifti: tuple[dict[str, Any] | None, ...],
    ) -> None:
        self.volume, self.grid, self.volumes, self.extras = volume, grid, volumes, extras
        self.names, self.nifti = names, nifti
        self._report: Any = report

    @property
    def report(self) -> dict[str, Any]:
        """Counts of voxels and tetrahedra, seconds of the stages, totals, back end."""
        if not isinstance(self._report, dict):  # made when it is wanted
            self._report = self._report.dict()
        return self._report

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_report": self.report}

    def __getattr__(self, name: str) -> np.ndarray:
        extras = self.__dict__.get("extras", {})
        if name in extras:
            return extras[name]
        hint = f"; ask for it by outputs=({name!r},)" if name in EXTRAS else ""
        raise AttributeError(f"WarpResult has no {name!r}{hint}")

    def __repr__(self) -> str:
        counts = self.report["counts"]
        share = counts["covered"] / max(counts["voxels"], 1)
        extras = f", with {', '.join(self.extras)}" if self.extras else ""
        return (
            f"WarpResult({describe(self.volume)}{extras}; {share:.1%} of {counts['voxels']} voxels "
            f"covered, {1e3 * self.report['timings']['total']:.1f} ms on {self.report['backend']})"
        )
