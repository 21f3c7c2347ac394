"""Warps of volumes by the steps of a deformed mesh."""

from __future__ import annotations

import json
from typing import Any, Callable, Dict, List, Sequence, Tuple

import numpy as np

from . import _core
from ._arrays import (
    check_cells,
    check_finite,
    given_cells_of,
    listed_outs,
    maker_of,
    outs_of,
    points_of,
    renamed,
    with_remedy,
)
from ._device import Device, on_device, type_of
from ._grid import Grid, make_grid, reference_grid
from ._mesh import Cells
from ._result import EXTRAS, WarpResult
from ._sources import default_value_of, gaussian_of, quantities_of, sources_of, warn_of_rounding
from ._values import check_callback, flag_of, integer_of, list_of, number_of, word_of

Progress = Callable[[float], Any]
#: Of a step: arrays of the volumes, further ones by name, and the `out` that was given.
_Arrays = Tuple[List[Any], Dict[str, Any], Any]
#: Names of arguments in the library's errors, and here.
RENAMED = {"background": "default_value", "filter": "interpolator",
           "label gaussian": "label_gaussian", "label rule": "label_rule",
           "quantities": "quantity", "source": "volume", "sources": "volume"}


def extras_of(outputs: Sequence[str], allowed: dict[str, Any]) -> list[str]:
    """Names of further outputs, checked."""
    names = [outputs] if isinstance(outputs, str) else list_of(outputs, "outputs", "words")
    for name in names:
        if word_of(name, "outputs") not in allowed:
            raise ValueError(f"outputs: {name!r} is not one of {', '.join(allowed)}")
    return names


def _named(error: Exception, positions: Any) -> Exception:
    """An error of a step in words of the package."""
    if isinstance(positions, np.ndarray):
        check_finite(positions, "deformed")
    return with_remedy(error)


class Warper:
    """Warps volumes step by step and keeps memory between the steps.

    The owner of a voxel is the lowest-numbered tetrahedron whose closed deformed shape contains the
    voxel's center, decided in exact integers. The samples of the sources are read in place: they
    must not change while the Warper exists. Not for use by several threads at once.

    Parameters
    ----------
    volume : Volume, or samples of shape (z, y, x) or (z, y, x, c), of 8- to 64-bit integers,
        float32 or float64, of NumPy or by DLPack; or a list of these on one grid. Arrays of
        PyTorch and CuPy in the memory of a CUDA device stay there
    rest : (n, 3) node positions at rest, x y z [world]
    cells : (m, 4) tetrahedra, or (m, 10) with nodes on their edges, see Mesh, (k, 8) hexahedra, or a
        pair of both; integers. Tetrahedra of ten nodes are mapped by quadratic shape functions. They
        give values as they are: no antialias, intensity, quantity, label_rule and forward field,
        for which split_ten_nodes() cuts them
    spacing, origin, direction, affine : of the grid of arrays, see Grid
    interpolator : ``"linear"``, ``"nearest"``, ``"cubic"``, ``"bspline"``, ``"lanczos"`` or
        ``"labels"`` (64-bit integers: ``"nearest"`` and ``"labels"`` only)
    label_rule : the label of a voxel is that of most ``"linear"`` weight, of most exact
        ``"volume"`` in its box, or of most ``"gaussian"`` weight, as of sitkLabelGaussian
    label_gaussian : standard deviation [source voxel] and cutoff [standard deviation]
    default_value : of voxels that no cell covers; integers round it half to even and saturate, float32
        takes the nearest number
    outside : ``"background"``: they get `default_value`; ``"identity"``: the source at the same
        position; ``"nearest"``: the source displaced as the nearest point of the mesh's surface;
        ``"falloff"``: the same with displacements that fall to zero smoothly over `falloff`
    falloff : that distance, above 0 [world]
    reference : Grid of the output, or something that has one: a Volume, a result, an image of
        nibabel or SimpleITK; None: the grid of the source
    overshoot : ``"keep"``, or ``"clamp"`` to the range of the samples
    antialias : averages where the mesh shrinks the source
    intensity : ``"value"``, ``"density"`` (amounts per volume) or ``"conservative"`` (the same,
        averaged exactly)
    quantity : what components are: ``"components"``, ``"rotate"``, ``"covariant"``,
        ``"contravariant"`` (vectors), ``"finite-strain"``, ``"principal"`` (tensors); a word, or
        one per volume
    backend : ``"auto"``, ``"cpu"``, ``"cuda"`` or ``"reference"``
    device : number of a CUDA device; that of the volume, if it is on one
    threads : of the CPU, 0: all processors; any number gives the same bits

    Warns
    -----
    RuntimeWarning
        the type of the samples has not the default value; the text tells the one that is stored.

    Raises
    ------
    ValueError
        naming the argument that is wrong and what it should be.
    CudaError
        `backend` is ``"cuda"`` and the device is not usable.

    >>> import tetwarp
    >>> volume = tetwarp.phantom(shape=(20, 24, 32))
    >>> mesh = tetwarp.lattice_mesh(volume, cells=3)
    >>> with Warper(volume, *mesh) as warper:
    ...     for time in (0.5, 1.0):
    ...         result = warper(tetwarp.deform(*mesh, time=time))
    >>> result.volume.shape
    (20, 24, 32)
    """

    def __init__(
        self,
        volume: Any,
        rest: Any,
        cells: Cells,
        *,
        spacing: Any = None,
        origin: Any = None,
        direction: Any = None,
        affine: Any = None,
        interpolator: str = "linear",
        label_rule: str = "linear",
        label_gaussian: tuple[float, float] = (1.0, 1.0),
        default_value: float = 0.0,
        outside: str = "background",
        falloff: float = 0.0,
        reference: Any = None,
        overshoot: str = "keep",
        antialias: bool = False,
        intensity: str = "value",
        quantity: Any = None,
        backend: str = "auto",
        device: int = 0,
        threads: int = 0,
    ) -> None:
        falloff, gaussian = number_of(falloff, "falloff"), gaussian_of(label_gaussian, label_rule)
        if falloff and outside != "falloff":
            raise ValueError(f'falloff: is for outside="falloff", got outside={outside!r}')
        given = list(volume) if isinstance(volume, (list, tuple)) else [volume]
        self._device = Device(given[0], "volume") if given and on_device(given[0]) else None
        if self._device is None:
            sources = sources_of(volume, spacing, origin, direction, affine)
            self._arrays = [source.array for source in sources]
            self._names = tuple(source.name for source in sources)
            self._nifti = tuple(source.nifti for source in sources)
            grid = sources[0].grid
        else:
            self._arrays = self._device.sources_of(given)
            self._names, self._nifti = ("values",) * len(given), (None,) * len(given)
            grid = make_grid(self._arrays[0].shape[:3], spacing, origin, direction, affine)
            backend, device = self._device.backend(backend), self._device.number
        self._grid = grid if reference is None else reference_grid(reference)
        self._makers = [maker_of(one) for one in given]
        background = default_value_of(default_value, self._arrays)
        points = points_of(rest, "rest")
        corners = given_cells_of(cells, "cells", len(points))
        self._node_count = len(points)
        try:
            self._warper: _core.Warper | None = _core.Warper(
                self._arrays, grid._core(), points, *corners,
                interpolator=interpolator, label_rule=label_rule,
                label_gaussian=gaussian, overshoot=overshoot, antialias=flag_of(antialias, "antialias"),
                intensity=intensity, quantities=quantities_of(quantity, len(given)),
                outside=outside, falloff=falloff,
                default_value=background,
                output_grid=None if reference is None else self._grid._core(),
                backend=backend, device=integer_of(device, "device"),
                threads=integer_of(threads, "threads"),
            )
        except (TypeError, ValueError) as error:  # the library has other names for arguments
            check_finite(points, "rest")
            check_cells(corners, "cells", len(points))
            for name, word in (("interpolator", interpolator), ("label_rule", label_rule),
                               ("overshoot", overshoot),
                               ("intensity", intensity), ("outside", outside),
                               ("backend", backend)):
                word_of(word, name)
            raise with_remedy(renamed(error, RENAMED)) from None
        if background and outside == "background":
            warn_of_rounding(background, self._arrays)
        self._is_source_grid = self._grid == grid

    @property
    def grid(self) -> Grid:
        """Grid of the outputs."""
        return self._grid

    @property
    def report(self) -> dict[str, Any]:
        """Sums over all steps so far, and the records of the last ones, 500 at least."""
        return json.loads(self._open().report())

    def __call__(
        self,
        deformed: Any,
        *,
        out: Any = None,
        outputs: Sequence[str] = (),
        progress: Progress | None = None,
    ) -> WarpResult:
        """Warps by one set of node positions.

        Parameters
        ----------
        deformed : (n, 3) positions of the nodes [world]; read in place if float64 in C order, also
            on the device of the volume
        out : array to write to, of the shape and type of the output, in C order, of NumPy or by
            DLPack; for several volumes a list of them. None: new arrays, of the library of the
            source
        outputs : further outputs: ``"mask"`` (1 where covered), ``"owner"`` (number of the cell,
            -1: none), ``"displacement"`` (rest position minus voxel's position), ``"jacobian"``
            (det F), ``"gradient"`` (F, row by row), ``"strain"`` (Green-Lagrange, XX YY ZZ XY YZ
            XZ), ``"forward"`` (deformed minus rest position, on the grid of the source)
        progress : called with the finished fraction of the step; False ends it

        Raises
        ------
        ValueError
            naming the argument.
        Cancelled
            `progress` returned False. Ctrl-C raises KeyboardInterrupt. Outputs are then undefined.
        RuntimeError
            the Warper is closed, or a step of it is running or in flight.
        """
        warper = self._open()
        positions, given, stream = self._checked(deformed, out, outputs, progress)
        try:
            report = warper.step(positions, *given[:2], stream, progress)
        except (TypeError, ValueError) as error:
            raise _named(error, positions) from None
        return self._result(given, report)

    step = __call__

    def begin_step(
        self,
        deformed: Any,
        *,
        out: Any = None,
        outputs: Sequence[str] = (),
        progress: Progress | None = None,
    ) -> None:
        """Begins a step, which `finish_step` ends; two may be in flight. On a GPU the call returns
        when the step is queued, so that the result of one step is copied to the host while the next
        one is computed; elsewhere it computes the step. Results have the bits of single steps.

        Parameters and errors as of a call. A call that raises has begun no step. `deformed` may be
        changed afterwards where it is in memory of the host. `out` and all arrays of the step belong
        to it until it is finished, and are kept as long, also if the Warper is closed meanwhile.

        >>> import tetwarp
        >>> volume = tetwarp.phantom(shape=(20, 24, 32))
        >>> mesh = tetwarp.lattice_mesh(volume, cells=3)
        >>> results = []
        >>> with Warper(volume, *mesh) as warper:
        ...     for time in (0.25, 0.5, 0.75, 1.0):
        ...         warper.begin_step(tetwarp.deform(*mesh, time=time))
        ...         if warper.steps_in_flight == 2:
        ...             results.append(warper.finish_step())
        ...     results.append(warper.finish_step())
        >>> [result.report["step"] for result in results]
        [0, 1, 2, 3]
        """
        warper = self._open()
        positions, given, stream = self._checked(deformed, out, outputs, progress)
        try:
            warper.begin_step(positions, *given[:2], stream, progress, given)
        except (TypeError, ValueError) as error:
            raise _named(error, positions) from None

    def finish_step(self) -> WarpResult:
        """Ends the oldest step in flight and returns its result.

        Raises
        ------
        RuntimeError
            no step is in flight, or the Warper is closed.
        ValueError, CudaError
            what was wrong with this step; later ones go on.
        """
        given: Any
        given, report = self._open().finish_step()
        return self._result(given, report)

    @property
    def steps_in_flight(self) -> int:
        """Steps that have begun and are not finished, 0 to 2."""
        return self._open().steps_in_flight

    def close(self) -> None:
        """Frees the memory; further calls are errors."""
        self._warper = None
        self._arrays = []

    def __enter__(self) -> Warper:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        state = "closed" if self._warper is None else f"{len(self._arrays)} volume(s)"
        return f"Warper({state}, {self._node_count} nodes, output {self._grid.shape})"

    def _open(self) -> _core.Warper:
        if self._warper is None:
            raise RuntimeError("Warper: it is closed")
        return self._warper

    def _checked(
        self, deformed: Any, out: Any, outputs: Sequence[str], progress: Progress | None
    ) -> tuple[Any, _Arrays, int]:
        """The positions, the arrays and the stream of a step."""
        if self._device is not None and on_device(deformed):
            shape = (self._node_count, 3)
            positions = self._device.array_of(deformed, "deformed", shape, "float64")
        else:
            positions = points_of(deformed, "deformed", self._node_count)
        check_callback(progress, "progress")
        names = extras_of(outputs, EXTRAS)
        if "forward" in names and not self._is_source_grid:
            raise ValueError("outputs: 'forward' is on the grid of the source; give no reference")
        arrays = self._outputs(out)
        extras = {name: self._extra(name) for name in names}
        stream = 0 if self._device is None else self._device.stream
        return positions, (arrays, extras, out), stream

    def _result(self, given: _Arrays, report: _core.StepReport) -> WarpResult:
        arrays, extras, out = given
        if out is None and self._device is not None:
            volumes = tuple(arrays)
        elif out is None:
            volumes = tuple(make(array) for make, array in zip(self._makers, arrays))
        else:
            volumes = tuple(out) if isinstance(out, (list, tuple)) else (out,)
        if self._device is None:
            extras = {name: self._makers[0](array) for name, array in extras.items()}
        return WarpResult(
            volumes[0], self._grid, report, volumes, extras, self._names, self._nifti
        )

    def _outputs(self, out: Any) -> list[Any]:
        shapes = [self._grid.shape + tuple(source.shape[3:]) for source in self._arrays]
        device = self._device
        if out is None and device is not None:
            return [device.empty_like(a, s) for s, a in zip(shapes, self._arrays)]
        if out is None:
            return [np.empty(s, a.dtype) for s, a in zip(shapes, self._arrays)]
        if device is None:
            return outs_of(out, shapes, self._arrays)
        given = listed_outs(out, len(shapes))
        for (name, array), shape, source in zip(given, shapes, self._arrays):
            device.array_of(array, name, shape, type_of(source))
        return [array for _, array in given]

    def _extra(self, name: str) -> Any:
        dtype, components = EXTRAS[name]
        shape = self._grid.shape + ((components,) if components > 1 else ())
        if self._device is not None:
            return self._device.empty(shape, np.dtype(dtype).name)
        return np.empty(shape, dtype)
