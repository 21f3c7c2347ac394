"""Contacts from step to step: which is which, what bonds them, and how they pressed last."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Sequence

import numpy as np

from . import _core
from ._arrays import array_of, in_order, integers_of, numbers_of, points_of
from ._contact import ContactProblem, ContactSolution
from ._values import check_kind, integer_of, list_of, number_of, word_of

_MATERIAL = (
    "friction", "stiffness", "tangential_stiffness", "energy", "viscosity", "bonding_rate",
    "saturation_pressure", "initial_intensity", "restitution",
)
#: Members of a table of contacts: columns, type, whether they must be given.
_CONTACTS: dict[str, tuple[int, Any, bool]] = {
    "keys": (4, np.int32, True), "point_a": (3, float, True), "point_b": (3, float, True),
    "normal": (3, float, True), "area": (1, float, False), "material": (1, np.int32, False),
    "tangent": (3, float, False), "approach_speed": (1, float, False),
    "surface_velocity": (3, float, False), "obstacle_velocity": (3, float, False),
    "bonded_share": (1, float, False), "vertices_a": (3, np.int32, False),
    "vertices_b": (3, np.int32, False), "weights_a": (3, float, False),
    "weights_b": (3, float, False),
}


def _column_of(value: Any, name: str, count: int, width: int, dtype: Any) -> np.ndarray:
    """A column of a table: `count` rows of `width` numbers."""
    shape = (count,) if width == 1 else (count, width)
    array = array_of(value, name)
    if array.size == 0 and count == 0:
        return np.empty(shape, dtype)
    if array.shape != shape or array.dtype.kind not in ("iu" if dtype is np.int32 else "iuf"):
        kind = "integers" if dtype is np.int32 else "numbers"
        raise ValueError(
            f"{name}: expected {kind} of shape {shape}, got {array.dtype} of {array.shape}"
        )
    if dtype is np.int32:
        return integers_of(array, name).reshape(shape)
    return in_order(array, dtype)


def _bodies_of(bodies: Sequence[Any]) -> list[np.ndarray]:
    """Per body its vertices, or position and rotation in one array."""
    places = []
    for number, body in enumerate(list_of(bodies, "bodies", "a list of bodies")):
        name = f"bodies[{number}]"
        is_two = isinstance(body, (tuple, list)) and len(body) == 2
        if is_two and (isinstance(body, tuple) or np.size(body[1]) == 4):
            position = numbers_of(body[0], f"{name}: position", 3)
            rotation = numbers_of(body[1], f"{name}: rotation w, x, y, z", 4)
            places.append(np.concatenate([position, rotation]))
            continue
        vertices = points_of(body, name)
        if not len(vertices):
            raise ValueError(f"{name}: expected vertices, or (position, rotation) of a rigid body")
        places.append(vertices)
    return places


class TrackedContacts(NamedTuple):
    """The contacts of a step, sorted by key.

    keys : (n, 4) int32: body a, its feature, body b, its feature
    point_a, point_b : (n, 3), where the impulse acts on either body [world]
    axes : (n, 3, 3), rows normal, tangent 1, tangent 2 [world]; impulses are along them
    gap : (n, 3) along the axes [m]; the tangential ones between the points that are bonded
    is_reported : (n,) bool, False: kept because it adheres
    vertices_a, vertices_b, weights_a, weights_b : (n, 3), the points of deformable bodies
    rebound_speed : (n,), the least separating speed by restitution [m/s]
    """

    keys: np.ndarray
    point_a: np.ndarray
    point_b: np.ndarray
    axes: np.ndarray
    gap: np.ndarray
    is_reported: np.ndarray
    vertices_a: np.ndarray
    vertices_b: np.ndarray
    weights_a: np.ndarray
    weights_b: np.ndarray
    rebound_speed: np.ndarray

    def __repr__(self) -> str:
        kept = int((~self.is_reported).sum())
        return f"TrackedContacts({len(self.keys)}, of them {kept} kept by adhesion)"


@dataclass(eq=False)
class ContactRecords:
    """What is kept of each contact between steps, sorted by key. `table` holds further members,
    with which a tracker goes on as if it had never stopped; all of it can be pickled.

    keys : (n, 4) int32, as in TrackedContacts
    intensity : (n,), beta: 0 debonded to 1 bonded
    area : (n,) [m^2]
    impulse : (n, 3), of the last step on body a [N s, world]
    has_touched : (n,) bool
    """

    table: dict[str, np.ndarray]

    @property
    def keys(self) -> np.ndarray:
        return self.table["keys"]

    @property
    def intensity(self) -> np.ndarray:
        return self.table["intensity"]

    @property
    def area(self) -> np.ndarray:
        return self.table["area"]

    @property
    def impulse(self) -> np.ndarray:
        return self.table["impulse"]

    @property
    def has_touched(self) -> np.ndarray:
        return self.table["has_touched"].view(bool)

    def __len__(self) -> int:
        return len(self.keys)

    def __repr__(self) -> str:
        return f"ContactRecords({len(self)}, {int((self.intensity > 0).sum())} bonded)"


class AdhesionStep(NamedTuple):
    """How adhesion changed in a step, per contact of the step.

    intensity : (n,), beta at the end
    gap : (n, 3) along the axes of the contacts [m]
    debonded : (n,) bool, whether the bond broke in this step
    """

    intensity: np.ndarray
    gap: np.ndarray
    debonded: np.ndarray


class ContactTracker:
    """Follows contacts through the steps of a simulation of yours: a contact keeps its identity,
    its bond and its impulse as long as its key, or its place, stays. A step is

        contacts = tracker.begin_step(found, bodies, time_step)
        problem = tracker.fill(ContactProblem(system=, jacobian=, load=))
        solution = solver.solve(problem)
        tracker.end_step(solution, moved_bodies)

    where the rows of the jacobian are along `contacts.axes`. `begin_step` may be called again in
    the same step with other contacts. Adhering contacts stay when they are no longer reported.

    Parameters
    ----------
    materials : dicts of friction, stiffness [N/m^3], tangential_stiffness, energy [J/m^2],
        viscosity, bonding_rate, saturation_pressure, initial_intensity (beta of a contact that
        touches for the first time), restitution; what is missing is 0
    records : ContactRecords of an earlier tracker that this one continues
    match_distance : a new key continues a record of the same bodies at most so far away [m]
    touch_distance : largest gap that counts as touching [m]
    restitution_speed : contacts that approach no faster do not rebound [m/s]
    integrator : of the intensity, ``"exact"`` or ``"explicit-euler"``
    debond_gap_factor : a contact debonds beyond this multiple of sqrt(energy / stiffness)
    debond_intensity : a contact in traction debonds below this intensity
    threads : 0: all processors; any number gives the same bits

    Raises
    ------
    ValueError
        naming the material, record or option that is wrong.

    >>> tracker = ContactTracker([dict(friction=0.5, stiffness=1e6, initial_intensity=1)])
    >>> floor, ball = ((0, 0, 0), (1, 0, 0, 0)), ((0, 0, 1), (1, 0, 0, 0))
    >>> contacts = tracker.begin_step(
    ...     dict(keys=[(1, 0, 0, 0)], point_a=[(0, 0, 0)], point_b=[(0, 0, 0)],
    ...          normal=[(0, 0, 1)], area=[0.01]), [floor, ball], 0.01)
    >>> contacts.keys.tolist(), contacts.is_reported.tolist()
    ([[0, 0, 1, 0]], [True])
    >>> step = tracker.end_step(np.zeros((1, 3)), [floor, ball])
    >>> tracker.records
    ContactRecords(1, 1 bonded)
    """

    def __init__(
        self,
        materials: Sequence[dict[str, float]] = ({},),
        *,
        records: ContactRecords | None = None,
        match_distance: float = 0.0,
        touch_distance: float = 0.0,
        restitution_speed: float = 0.0,
        integrator: str = "exact",
        debond_gap_factor: float = 10.0,
        debond_intensity: float = 1e-3,
        threads: int = 1,
    ) -> None:
        if records is not None and "keys" not in getattr(records, "table", ()):
            raise ValueError(f"records: expected those of a tracker, got {type(records).__name__}")
        materials = list_of(materials, "materials", "a list of dicts")
        for number, material in enumerate(materials):
            if not isinstance(material, dict):
                raise ValueError(f"materials[{number}]: expected a dict, got {material!r}")
            for name in material:
                if name not in _MATERIAL:
                    raise ValueError(
                        f"materials[{number}]: {name!r} is not one of {', '.join(_MATERIAL)}"
                    )
        given = [
            {name: number_of(value, f"materials[{number}][{name!r}]")
             for name, value in material.items()}
            for number, material in enumerate(materials)
        ]
        numbers = {
            name: number_of(value, name) for name, value in (
                ("match_distance", match_distance), ("touch_distance", touch_distance),
                ("restitution_speed", restitution_speed),
                ("debond_gap_factor", debond_gap_factor), ("debond_intensity", debond_intensity),
            )
        }
        self._tracker = _core.ContactTracker(
            given, numbers, word_of(integrator, "integrator"), integer_of(threads, "threads"),
            0 if records is None else len(records), {} if records is None else records.table,
        )
        self._count: int | None = None

    def begin_step(
        self, contacts: dict[str, Any], bodies: Sequence[Any], time_step: float
    ) -> TrackedContacts:
        """Matches the contacts that a collision detection has found with those of earlier steps.

        Parameters
        ----------
        contacts : dict of arrays with a row per contact, in any order: keys (n, 4), body a, its
            feature, body b, its feature; point_a, point_b (n, 3) on the bodies; normal (n, 3),
            unit, from b to a; area (n,) [m^2], without which nothing adheres; material (n,),
            number in `materials`; tangent (n, 3); approach_speed (n,); surface_velocity,
            obstacle_velocity (n, 3); bonded_share (n,), in (0, 1]; of deformable bodies
            vertices_a, vertices_b (n, 3), numbers of vertices or -1, and weights_a, weights_b
        bodies : per body at the start of the step (position, rotation), a quaternion w, x, y, z; or
            of a deformable body its vertices (n, 3)
        time_step : [s]

        Raises
        ------
        ValueError
            naming the member, contact or body that is wrong. Nothing has changed then.
        """
        if not isinstance(contacts, dict):
            raise ValueError(f"contacts: expected a dict of arrays, got {type(contacts).__name__}")
        for name in contacts:
            if name not in _CONTACTS:
                raise ValueError(f"contacts: {name!r} is not one of {', '.join(_CONTACTS)}")
        keys = array_of(contacts.get("keys", ()), "contacts['keys']")
        count = len(keys) if keys.ndim else 0
        table = {}
        for name, (width, dtype, is_required) in _CONTACTS.items():
            if name in contacts:
                table[name] = _column_of(contacts[name], f"contacts[{name!r}]", count, width, dtype)
            elif is_required:
                raise ValueError(f"contacts: expected {name!r}")
        found = self._tracker.begin_step(
            count, table, _bodies_of(bodies), number_of(time_step, "time_step")
        )
        self._count = len(found["keys"])
        found["axes"] = found["axes"].reshape(-1, 3, 3)
        found["is_reported"] = found["is_reported"].view(bool)
        return TrackedContacts(**{name: found[name] for name in TrackedContacts._fields})

    def fill(self, problem: ContactProblem) -> ContactProblem:
        """A copy of a problem in global form with velocity offset, friction, adhesion and impulse
        guess of the contacts of this step.

        Raises
        ------
        ValueError
            the problem has another number of contacts than the step.
        RuntimeError
            no step has begun.
        """
        check_kind(problem, ContactProblem, "problem")
        filled = replace(problem, **self._tracker.fill())
        rows = 3 * (self._count or 0)
        if filled.jacobian is not None and filled.jacobian.shape[0] != rows:
            raise ValueError(f"problem: expected a jacobian of {rows} rows, 3 per contact of the "
                             f"step, got {filled.jacobian.shape[0]}")
        return filled

    def end_step(
        self, solution: ContactSolution | np.ndarray, bodies: Sequence[Any], *, velocity: Any = None,
        pressing: Any = None,
    ) -> AdhesionStep:
        """Ends the step: bonds stretch, grow or break, impulses are kept for the next start.

        Parameters
        ----------
        solution : of the problem of fill(), or its impulses (n, 3), along the axes [N s]
        bodies : as in begin_step(), at the end of the step
        velocity : (n, 3) of the contacts where impulses are given [m/s]; None: 0
        pressing : (n,) normal impulse that presses on the area of each contact and so forms its bond
            [N s], where contacts without an area stand beside those that have that of a surface, and
            take a part of what presses on it; None: the contact's own

        Raises
        ------
        ValueError
            naming the contact or body that is wrong.
        RuntimeError
            no step has begun.
        """
        if isinstance(solution, ContactSolution):
            if velocity is not None:
                raise ValueError("velocity: the solution has its own; leave it out")
            impulse, velocity = solution.impulse, solution.velocity
        else:
            impulse = array_of(solution, "solution: impulse")
            velocity = np.zeros(impulse.shape) if velocity is None else velocity
        count = self._count
        if count is None:  # the library refuses it
            count = impulse.shape[0] if np.ndim(impulse) else 0
        impulse = _column_of(impulse, "solution: impulse", count, 3, float)
        velocity = _column_of(velocity, "velocity", count, 3, float)
        pressed = np.empty(0) if pressing is None else _column_of(
            pressing, "pressing", count, 1, float)
        step = self._tracker.end_step(impulse, velocity, pressed, _bodies_of(bodies))
        self._count = None
        return AdhesionStep(step["intensity"], step["gap"], step["debonded"].view(bool))

    @property
    def records(self) -> ContactRecords:
        """The state of all contacts; within a step one record for each contact of it."""
        return ContactRecords(self._tracker.records())

    def __repr__(self) -> str:
        return f"ContactTracker({self.records!r})"
