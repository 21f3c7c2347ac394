"""Contact problems of one time step."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields
from typing import Any, Callable, Iterable, NamedTuple

import numpy as np

from . import _core
from ._arrays import array_of, integers_of, numbers_of
from ._values import check_callback, check_kind, integer_of, number_of, word_of


class Csr(NamedTuple):
    """A sparse matrix by rows, as scipy.sparse.csr_array has it; `tocsr` makes one.

    data : (entries,) float64
    indices : (entries,) columns
    indptr : (rows + 1,) where each row begins
    shape : (rows, columns)
    """

    data: np.ndarray
    indices: np.ndarray
    indptr: np.ndarray
    shape: tuple[int, int]

    def tocsr(self) -> Any:
        """As scipy.sparse.csr_array, which shares the arrays."""
        import scipy.sparse  # type: ignore[import-untyped, unused-ignore]

        return scipy.sparse.csr_array((self.data, self.indices, self.indptr), shape=self.shape)

    def __repr__(self) -> str:
        return f"Csr({self.shape[0]} x {self.shape[1]}, {len(self.data)} entries)"


def _is_csr(value: Any, name: str) -> bool:
    """Whether it is a tuple of the members of a Csr, not four rows of numbers. Raises ValueError where
    it may be both: a single row of two entries, or four rows of two numbers.
    """
    if isinstance(value, Csr):
        return True
    if not isinstance(value, tuple) or len(value) != 4:
        return False
    try:
        sizes = {len(part) for part in value}
    except TypeError:  # csr_of() names the member
        return True
    if sizes != {2}:
        return len(sizes) > 1
    (rows, columns), (start, end) = value[3], value[2]
    try:
        can_be = (rows, start, end) == (1, 0, 2) and all(0 <= c < columns for c in value[1])
    except (TypeError, ValueError):  # no numbers
        return False
    if can_be:
        raise ValueError(f"{name}: may be a sparse row of two entries or four rows of two numbers; "
                         "give tetwarp.Csr(data, indices, indptr, shape) or numpy.array(rows)")
    return False


def csr_of(value: Any, name: str) -> Csr:
    """A matrix of SciPy, a Csr or tuple of its members, or a dense array."""
    if hasattr(value, "tocsr") and not isinstance(value, Csr):
        value = value.tocsr()
        value = Csr(value.data, value.indices, value.indptr, value.shape)
    if _is_csr(value, name):
        data, indices, indptr, shape = value
    else:
        dense = array_of(value, name)
        if dense.ndim != 2 or dense.dtype.kind not in "iuf":
            raise ValueError(
                f"{name}: expected a sparse matrix of SciPy, (data, indices, indptr, shape) or an "
                "array of two axes"
            )
        rows, indices = np.nonzero(dense)
        data, shape = dense[rows, indices], dense.shape
        indptr = np.searchsorted(rows, np.arange(dense.shape[0] + 1))
    size = integers_of(shape, f"{name}.shape", np.int64)
    if len(size) != 2:
        raise ValueError(f"{name}.shape: expected rows and columns, got {shape!r}")
    csr = Csr(
        numbers_of(data, f"{name}.data"),
        integers_of(indices, f"{name}.indices"),
        integers_of(indptr, f"{name}.indptr", np.int64),
        (int(size[0]), int(size[1])),
    )
    if len(csr.data) != len(csr.indices):
        raise ValueError(f"{name}.indices: expected {len(csr.data)}, got {len(csr.indices)}")
    if len(csr.indptr) != csr.shape[0] + 1:
        raise ValueError(f"{name}.indptr: expected {csr.shape[0] + 1}, got {len(csr.indptr)}")
    return csr


_MATRICES = ("system", "jacobian", "delassus")
_VECTORS = (
    "load", "velocity_offset", "free_velocity", "friction", "second_friction", "impulse_guess",
)


#: Members of further rows; `True`: numbers, `False`: integers.
_ROWS = {
    "bilateral": {"target": True, "compliance": True, "group_start": False, "impulse_guess": True},
    "rolling": {"contact": False, "rolling": True, "torsion": True, "impulse_guess": True},
}


#: Members of adhesion per contact.
_ADHESION = (
    "area", "stiffness", "tangential_stiffness", "intensity", "gap", "energy", "viscosity",
    "bonding_rate", "saturation_pressure",
)


def _check_members(given: Any, name: str, needed: str, others: Iterable[str]) -> None:
    """Raises ValueError for what is no dict, lacks the needed member, or has unknown ones."""
    if not isinstance(given, dict) or needed not in given:
        raise ValueError(f"{name}: expected a dict with {needed}")
    for key in given:
        if key != needed and key not in others:
            raise ValueError(f"{name}: {key!r} is not one of {needed}, {', '.join(others)}")


def _adhesion_of(given: Any) -> dict[str, Any]:
    """Adhesion of contacts, checked."""
    _check_members(given, "adhesion", "time_step", _ADHESION)
    return {
        name: (number_of if name == "time_step" else numbers_of)(value, f"adhesion.{name}")
        for name, value in given.items()
    }


def _rows_of(rows: Any, name: str, allowed: dict[str, bool]) -> dict[str, Any]:
    """Rows beyond those of contacts, checked."""
    _check_members(rows, name, "jacobian", allowed)
    result: dict[str, Any] = {"jacobian": csr_of(rows["jacobian"], f"{name}.jacobian")}
    for key, value in rows.items():
        if key == "jacobian":
            continue
        if allowed[key]:
            result[key] = numbers_of(value, f"{name}.{key}")
        else:
            result[key] = integers_of(value, f"{name}.{key}")
    return result


@dataclass(eq=False)
class ContactProblem:
    """Contacts of one time step in one of two forms; the members of the other form stay None:

        global:  A v = J^T r + b,  u = J v + w        local:  u = W r + q

    Each contact has three rows: normal, tangent 1, tangent 2. Matrices are given as SciPy sparse
    matrices, as a tuple (data, indices, indptr, shape), or as arrays of two axes, and are kept as Csr.

    system, jacobian : A [kg, kg m^2], symmetric positive definite, and J, (3 contacts, dofs)
    load, velocity_offset : b [N s], w [m/s]
    delassus, free_velocity : W [1/kg], (3 contacts, 3 contacts), and q [m/s]
    friction : mu, one per contact; its size is the number of contacts
    second_friction : mu along tangent 2, where it differs
    impulse_guess : r to start from, (3 contacts)
    block_start : first degree of freedom of each body, then their number
    adhesion : dict with time_step [s] and per contact area, stiffness, tangential_stiffness,
        intensity, gap (three), energy, viscosity, bonding_rate, saturation_pressure
    bilateral : dict of rows that hold with either sign, joints and couplings, in global form: its
        jacobian J_b, (rows, dofs), and per row target [m/s] and compliance [1/kg]; group_start,
        first row of each group of one to three that are solved together, then their number;
        impulse_guess. J_b v + compliance lambda = target
    rolling : dict of resistance to rolling and spinning, in global form: contact, the contact of
        each entry; its jacobian, (3 entries, dofs), to the angular velocity about normal, tangent 1
        and tangent 2; rolling and torsion [m] per entry; impulse_guess
    """

    system: Any = None
    jacobian: Any = None
    load: Any = None
    velocity_offset: Any = None
    delassus: Any = None
    free_velocity: Any = None
    friction: Any = None
    second_friction: Any = None
    impulse_guess: Any = None
    block_start: Any = None
    adhesion: dict[str, Any] | None = None
    bilateral: dict[str, Any] | None = None
    rolling: dict[str, Any] | None = None

    def __post_init__(self) -> None:
        for name in _MATRICES:
            if getattr(self, name) is not None:
                setattr(self, name, csr_of(getattr(self, name), name))
        for name in _VECTORS:
            if getattr(self, name) is not None:
                setattr(self, name, numbers_of(getattr(self, name), name))
        if self.block_start is not None:
            self.block_start = integers_of(self.block_start, "block_start")
        for name, allowed in _ROWS.items():
            if getattr(self, name) is not None:
                setattr(self, name, _rows_of(getattr(self, name), name, allowed))
        if self.adhesion is not None:
            self.adhesion = _adhesion_of(self.adhesion)

    @property
    def contact_count(self) -> int:
        return 0 if self.friction is None else int(np.size(self.friction))

    def __repr__(self) -> str:
        form = "local" if self.delassus is not None else "global"
        return f"ContactProblem({self.contact_count} contacts, {form} form)"

    def _core(self) -> dict[str, Any]:
        """The members that are given. They can be set at any time: they are checked here again."""
        def plain(value: Any) -> Any:
            if isinstance(value, dict):
                return {key: plain(part) for key, part in value.items()}
            return tuple(value) if isinstance(value, Csr) else value

        names = [f.name for f in fields(ContactProblem)]
        given = ContactProblem(*(getattr(self, name) for name in names))
        members = {name: plain(getattr(given, name)) for name in names}
        return {name: value for name, value in members.items() if value is not None}


@dataclass(eq=False)
class ContactSolution:
    """Impulses and velocities that solve a problem.

    impulse : r, (contacts, 3): normal, tangent 1, tangent 2 [N s]
    velocity : u, (contacts, 3) [m/s]
    body_velocity : v, (dofs,) [m/s, rad/s]; empty in local form
    bilateral_impulse : lambda of `bilateral`, (rows,)
    rolling_impulse : m of `rolling`, (entries, 3) [N m s]
    status : ``"converged"``, ``"not converged"``, ``"infeasible"`` or ``"unbounded"``
    report : what the solve did; its keys are in docs/formats.md
    """

    impulse: np.ndarray
    velocity: np.ndarray
    body_velocity: np.ndarray
    bilateral_impulse: np.ndarray
    rolling_impulse: np.ndarray
    status: str
    report: dict[str, Any] = field(default_factory=dict)

    @property
    def converged(self) -> bool:
        return self.status == "converged"

    @property
    def residual(self) -> float:
        """eta: relative, without unit."""
        return self.report["residual"]

    def __repr__(self) -> str:
        return (
            f"ContactSolution({len(self.impulse)} contacts, {self.status}, "
            f"residual {self.residual:.2g})"
        )


class ContactSolver:
    """Solves a series of problems; keeps memory, and structure while it stays the same.

    Keywords as of solve_contacts(). Not for use by several threads at once.

    >>> solver = ContactSolver(tolerance=1e-9)
    >>> for speed in (1.0, 2.0):
    ...     problem = ContactProblem(delassus=np.eye(3), free_velocity=[-speed, 0, 0], friction=[0.5])
    ...     print(solver.solve(problem).impulse[0, 0].round(6))
    1.0
    2.0
    """

    def __init__(
        self,
        *,
        law: str = "cone",
        rule: str = "parallel",
        method: str = "auto",
        measure: str = "eta",
        tolerance: float = 1e-6,
        max_sweeps: int = 100000,
        recovery_speed: float = np.inf,
        max_seconds: float = np.inf,
        backend: str = "auto",
        device: int = 0,
        threads: int = 0,
    ) -> None:
        self._solver = _core.ContactSolver(
            law=word_of(law, "law"), rule=word_of(rule, "rule"), method=word_of(method, "method"),
            measure=word_of(measure, "measure"), tolerance=number_of(tolerance, "tolerance"),
            max_sweeps=integer_of(max_sweeps, "max_sweeps", 2**63 - 1),
            recovery_speed=number_of(recovery_speed, "recovery_speed"),
            max_seconds=number_of(max_seconds, "max_seconds"), backend=word_of(backend, "backend"),
            device=integer_of(device, "device"), threads=integer_of(threads, "threads"),
        )

    def solve(
        self,
        problem: ContactProblem,
        *,
        progress: Callable[[float, int], Any] | None = None,
    ) -> ContactSolution:
        """Solves one problem; see solve_contacts()."""
        check_kind(problem, ContactProblem, "problem")
        members = problem._core()
        rows = [members[name][3][0] for name in ("jacobian", "delassus") if name in members]
        if "friction" not in members and any(rows):
            raise ValueError("friction: expected one number per contact")
        check_callback(progress, "progress")
        impulse, velocity, body_velocity, bilateral, rolling, text = self._solver.solve(
            members, progress
        )
        report = json.loads(text)
        return ContactSolution(
            impulse, velocity, body_velocity, bilateral, rolling, report["status"], report
        )


def solve_contacts(
    problem: ContactProblem | None = None,
    *,
    system: Any = None,
    jacobian: Any = None,
    load: Any = None,
    velocity_offset: Any = None,
    delassus: Any = None,
    free_velocity: Any = None,
    friction: Any = None,
    second_friction: Any = None,
    impulse_guess: Any = None,
    block_start: Any = None,
    adhesion: dict[str, Any] | None = None,
    bilateral: dict[str, Any] | None = None,
    rolling: dict[str, Any] | None = None,
    progress: Callable[[float, int], Any] | None = None,
    **options: Any,
) -> ContactSolution:
    """Solves one time step of frictional, adhesive contact.

    Parameters
    ----------
    problem : ContactProblem, or its members as keywords
    progress : called with seconds and sweeps so far; False ends the solve, which then returns its
        best iterate
    law : friction ``"cone"`` or ``"pyramid"``
    rule : of adhesion with friction, ``"parallel"`` or ``"restrictive"``
    method : ``"auto"``, or a single method for comparison
    measure, tolerance : of the residual, ``"eta"`` or ``"fclib"``, relative
    max_sweeps, max_seconds : limits
    recovery_speed : existing penetration is undone at most this fast [m/s]
    backend, device, threads : where to solve

    Returns
    -------
    ContactSolution. Not converging is a status, no error.

    Raises
    ------
    ValueError
        the problem or an option is invalid; names the member, the index and the remedy.
        Ctrl-C raises KeyboardInterrupt.

    A mass of 1 kg at 1 m/s above a floor, of friction 0.5, slides and stops falling:

    >>> solution = solve_contacts(delassus=np.eye(3), free_velocity=[-1, 2, 0], friction=[0.5])
    >>> solution.converged, solution.impulse[0, :2].round(6).tolist()
    (True, [1.0, -0.5])
    """
    members = {
        "system": system, "jacobian": jacobian, "load": load, "velocity_offset": velocity_offset,
        "delassus": delassus, "free_velocity": free_velocity, "friction": friction,
        "second_friction": second_friction, "impulse_guess": impulse_guess,
        "block_start": block_start, "adhesion": adhesion, "bilateral": bilateral,
        "rolling": rolling,
    }
    if problem is None:
        problem = ContactProblem(**members)
    elif any(value is not None for value in members.values()):
        raise ValueError("problem: give either a ContactProblem or its members")
    return ContactSolver(**options).solve(problem, progress=progress)
