"""Simulations of bodies that move and touch."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, Callable, Iterator, Union

import numpy as np

from . import _core
from ._arrays import vector_of
from ._grid import grid_from_core
from ._mesh import Mesh, Surface
from ._values import check_callback, flag_of, integer_of, is_masked, number_of, path_of, word_of
from ._volume import Volume

BodyName = Union[str, int]


class StepRecord(SimpleNamespace):
    """What a step did: time [s], energy [J], momentum, contacts, residuals, `bodies` by number, and
    more; docs/python.md lists the members."""

    def __repr__(self) -> str:
        return (
            f"StepRecord(time {self.time:.6g} s, energy {self.energy.total:.6g} J, "
            f"{self.contacts} contacts, converged {self.converged})"
        )


def _namespace(value: Any) -> Any:
    if isinstance(value, dict):
        return SimpleNamespace(**{key: _namespace(inner) for key, inner in value.items()})
    if isinstance(value, list):
        return [_namespace(inner) for inner in value]
    return np.array(value) if isinstance(value, tuple) else value


@dataclass(eq=False)
class Contacts:
    """Contacts at the end of a step, one row each.

    body_a, body_b : numbers of bodies; from their count on: obstacles
    position : (c, 3), in the middle between both surfaces [m]
    normal : (c, 3), unit, from b to a
    impulse : (c, 3), on a over the last part of the step, world axes [N s]
    gap : (c,), along the normal, less the thickness [m]
    area : (c,) [m^2]
    intensity : (c,), of the adhesion, 0 to 1
    """

    body_a: np.ndarray
    body_b: np.ndarray
    position: np.ndarray
    normal: np.ndarray
    impulse: np.ndarray
    gap: np.ndarray
    area: np.ndarray
    intensity: np.ndarray

    def __len__(self) -> int:
        return len(self.gap)

    def __repr__(self) -> str:
        return f"Contacts({len(self)})"


def _plain(value: Any) -> Any:
    """Arrays and numbers of NumPy in a scene, for JSON."""
    if is_masked(value):
        raise TypeError("masked elements are no values of JSON; use .filled(value)")
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{type(value).__name__} is no value of JSON")


def _check_finite_numbers(value: Any, key: str) -> None:
    """Raises ValueError for a number that JSON does not have, naming its key."""
    if isinstance(value, dict):
        for name, inner in value.items():
            _check_finite_numbers(inner, f"{key}.{name}" if key else f"{name}")
    elif isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.ndim):
        for number, inner in enumerate(value):
            _check_finite_numbers(inner, f"{key}[{number}]")
    elif isinstance(value, (float, np.floating)) and not np.isfinite(value):
        raise ValueError(f"{key}: expected a finite number, got {value}")


def _move_of(value: Any, name: str) -> tuple[float, float, float]:
    """Three finite numbers."""
    vector = vector_of(value, name)
    if not np.isfinite(vector).all():
        raise ValueError(f"{name}: expected three finite numbers, got {vector}")
    return vector


def shipped_scenes() -> list[str]:
    """Names of the scenes that come with the library.

    >>> "cantilever" in shipped_scenes()
    True
    """
    return list(_core.scene_names())


def shipped_scene(name: str) -> dict[str, Any]:
    """A scene that comes with the library, as a dict to change or to simulate.

    >>> shipped_scene("cantilever")["bodies"][0]["kind"]
    'fem'
    """
    return json.loads(_core.scene_text(word_of(name, "name")))


class Simulator:
    """Advances a scene through time.

    Parameters
    ----------
    scene : a dict as of a scene file (docs/scenes.md), whose numbers may be those of NumPy; or the
        path of a scene file
    folder : that names of files in a dict are relative to; default: the current one
    backend : ``"auto"``, ``"cpu"``, ``"cuda"`` or ``"reference"``
    device, threads : number of a CUDA device; threads of the CPU, 0: all (the same bits)
    untangle : elastic bodies and cloth that intersect at the start are shrunk and grow back
    max_step_seconds : wall time of a step, after which its solves end with what they have;
        ``record().out_of_time`` tells. Results then depend on the clock

    Raises
    ------
    IoError
        an OSError: the scene is wrong; names the key, the problem and the remedy.
    ValueError
        bodies cannot be simulated, for example because they intersect at the start.

    Bodies are named by name or number. Lengths are in meters, all units SI. Not for use by several
    threads at once.

    >>> simulator = Simulator(shipped_scene("cantilever"))
    >>> before = simulator.positions("beam")
    >>> simulator.step()
    True
    >>> bool((simulator.positions("beam") != before).any())
    True
    """

    def __init__(
        self,
        scene: Any,
        *,
        folder: Any = None,
        backend: str = "auto",
        device: int = 0,
        threads: int = 0,
        untangle: bool = False,
        max_step_seconds: float = float("inf"),
    ) -> None:
        is_current = folder is None or (isinstance(folder, str) and not folder)
        where = "" if is_current else path_of(folder, "folder")
        if isinstance(scene, dict):
            try:
                _check_finite_numbers(scene, "")
                file, text = "scene", json.dumps(scene, default=_plain, allow_nan=False)
            except (TypeError, ValueError, RecursionError) as error:
                raise ValueError(f"scene: {error}") from None
        elif isinstance(scene, (str, os.PathLike)):
            file, text = path_of(scene, "scene"), ""
            if where:
                raise ValueError("folder: is for a scene in a dict; names in a file are relative to "
                                 "it")
        else:
            raise ValueError(
                f"scene: expected a dict or the path of a file, got {type(scene).__name__}"
            )
        self._simulator = _core.Simulator(
            file, text, where, backend=word_of(backend, "backend"),
            device=integer_of(device, "device"), threads=integer_of(threads, "threads"),
            untangle=flag_of(untangle, "untangle"),
            max_step_seconds=number_of(max_step_seconds, "max_step_seconds"),
        )
        self._names = tuple(self._simulator.names)

    def step(
        self,
        count: int = 1,
        *,
        progress: Callable[[int, float, int], Any] | None = None,
    ) -> bool:
        """Advances by `count` time steps.

        Parameters
        ----------
        count : steps, at least 0
        progress : called within steps with the number of the step, its start [s] and the linear
            iterations so far; False ends the step, which then has no effect

        Returns
        -------
        False if `progress` ended a step

        Raises
        ------
        RuntimeError
            a step is not possible; the state is as before it.
        KeyboardInterrupt
            Ctrl-C; the step in which it came has no effect.
        """
        if integer_of(count, "count") < 0:
            raise ValueError(f"count: expected 0 or more steps, got {count}")
        check_callback(progress, "progress")
        return all(self._simulator.step(progress) for _ in range(count))

    def run(self) -> Iterator[int]:
        """Steps to the end of the scene, and yields the number of steps done after each.

        >>> simulator = Simulator({**shipped_scene("cantilever"), "duration": 0.02})
        >>> list(simulator.run()) == list(range(1, simulator.step_count + 1))
        True
        """
        while self.step_index < self.step_count:
            self.step()
            yield self.step_index

    @property
    def time(self) -> float:
        """[s]"""
        return self._simulator.time

    @property
    def time_step(self) -> float:
        """[s]"""
        return self._simulator.time_step

    @property
    def step_index(self) -> int:
        """Steps done."""
        return self._simulator.step_index

    @property
    def step_count(self) -> int:
        """Steps of the scene's duration."""
        return self._simulator.step_count

    @property
    def thickness(self) -> float:
        """Contact distance [m]."""
        return self._simulator.thickness

    @property
    def backend(self) -> str:
        """Where steps run."""
        return self._simulator.backend

    @property
    def names(self) -> list[str]:
        """Names of the bodies, by number."""
        return list(self._names)

    @property
    def obstacle_names(self) -> list[str]:
        """Names of the obstacles, which contacts number after the bodies."""
        return list(self._simulator.obstacle_names)

    def record(self) -> StepRecord:
        """Diagnostics of the last step, computed now."""
        record = _namespace(self._simulator.record())
        return StepRecord(**vars(record))

    def contacts(self) -> Contacts:
        """The contacts at the end of the last step."""
        return Contacts(**self._simulator.contacts())

    def mesh(self, body: BodyName) -> Mesh:
        """Nodes at rest and tetrahedra of an elastic body."""
        arrays = self._simulator.body(self._index(body))
        if len(arrays["tets"]) == 0:
            raise ValueError(f"body: {body!r} is of kind {arrays['kind']} and has no tetrahedra")
        return Mesh(arrays["points"], arrays["tets"])

    def positions(self, body: BodyName) -> np.ndarray:
        """World positions of the nodes of mesh(body), (n, 3) [m]."""
        return self._simulator.positions(self._index(body))

    def velocities(self, body: BodyName) -> np.ndarray:
        """Velocities of the nodes of mesh(body), (n, 3) [m/s]."""
        return self._simulator.velocities(self._index(body))

    def surface(self, body: BodyName) -> Surface:
        """The surface of a body, where it is now [m]."""
        index = self._index(body)
        triangles = self._simulator.body(index)["surface_triangles"]
        return Surface(self._simulator.surface_positions(index), triangles)

    def volume(self, body: BodyName) -> Volume:
        """The image that a body is made of; it shares the simulator's memory and is read-only."""
        image = self._simulator.image(self._index(body))
        if image is None:
            raise ValueError(f"body: {body!r} is not made of an image")
        samples, grid, name = image
        return Volume(samples, grid_from_core(grid), name)

    def jacobians(self, body: BodyName) -> np.ndarray:
        """det F of every tetrahedron of a body; negative where inverted."""
        return self._simulator.jacobians(self._index(body))

    def stresses(self, body: BodyName) -> np.ndarray:
        """Von Mises stress of every tetrahedron of a body [Pa]."""
        return self._simulator.stresses(self._index(body))

    def add_handle(
        self,
        name: str,
        body: BodyName,
        center: Any,
        stiffness: float,
        radius: float = 0.0,
        damping: float = 0.0,
    ) -> None:
        """Adds a handle, or replaces one of its name that was added: springs between anchors and the
        nodes of a body within the radius of a place now [m], or else the nearest one; of a rigid
        body the point at that place. Stiffness [N/m] and damping [N s/m] are totals. Raises
        ValueError naming what is wrong."""
        self._simulator.add_handle(
            word_of(name, "name"),
            self._names[self._index(body)],
            vector_of(center, "center"),
            number_of(radius, "radius"),
            number_of(stiffness, "stiffness"),
            number_of(damping, "damping"),
        )

    def move_handle(self, name: str, displacement: Any) -> None:
        """Moves the anchors of a handle from where they started, instead of its path [m]."""
        self._simulator.move_handle(word_of(name, "name"), _move_of(displacement, "displacement"))

    def release_handle(self, name: str) -> None:
        """The springs of a handle let go, until it is moved again."""
        self._simulator.release_handle(word_of(name, "name"))

    def move_script(self, name: str, displacement: Any, axis_angle: Any = (0, 0, 0)) -> None:
        """The pose of a scripted body or obstacle relative to its start [m, rad]."""
        self._simulator.move_script(
            word_of(name, "name"), _move_of(displacement, "displacement"),
            _move_of(axis_angle, "axis_angle"),
        )

    def checkpoint(self) -> bytes:
        """The whole state, to go on bit for bit in an equal scene with the same options."""
        return self._simulator.checkpoint()

    def restore(self, state: bytes) -> None:
        """Goes on from checkpoint(). Raises ValueError if it is not of this scene."""
        if not isinstance(state, (bytes, bytearray, memoryview)):
            raise ValueError(f"state: expected the bytes of checkpoint(), got {type(state).__name__}")
        self._simulator.restore(bytes(state))

    def __repr__(self) -> str:
        return (
            f"Simulator({len(self._names)} bodies, step {self.step_index} of {self.step_count}, "
            f"time {self.time:.6g} s)"
        )

    def _index(self, body: BodyName) -> int:
        if isinstance(body, str):
            if body not in self._names:
                raise ValueError(f"body: {body!r} is not one of {', '.join(self._names)}")
            return self._names.index(body)
        index = integer_of(body, "body")
        if not 0 <= index < len(self._names):
            raise ValueError(f"body: expected 0 to {len(self._names) - 1}, got {body}")
        return index
