"""Rows of the contact benchmark's results file, and those of other solvers."""
import re
from dataclasses import dataclass, field

from rows import read_rows

METHODS = ("automatic", "newton", "anderson", "nonlinear_cg", "gauss_seidel", "mass_splitting")

PEER_LINE = re.compile(
    r"(?P<file>\S+)\s+contacts\s+(?P<contacts>\d+)\s+tol\s+(?P<tolerance>\S+)\s+(?:ok|FAIL)"
    r"\s+sweeps\s+(?P<sweeps>\d+)\s+(?P<solver>\w+)\s+\S+\s+fclib\s+(?P<error>\S+)"
    r"\s+(?P<seconds>\S+)\s+s"
)


@dataclass
class Solve:
    """One timed solve. The parts of its name are fields, its counters a dictionary."""

    kind: str = "contact"  # contact, contact_skip, contact_scale or contact_coupling
    problem: str = ""
    method: str = ""
    precision: str = "float64"
    threads: int = 1
    tolerance: float = 0.0
    visit: str = "first"  # first, kept or warm
    without: str = ""
    coupling: str = "automatic"  # automatic, iterated or condensed
    time: float = 0.0  # median [ms]
    low: float = 0.0  # lower and upper quartile [ms]
    high: float = 0.0
    contended: bool = False
    error: float = 0.0  # of the result, in the measure that the tolerance bounds
    counters: dict = field(default_factory=dict)

    def __getitem__(self, counter):
        return self.counters[counter]

    def reaches(self, threshold):
        """Whatever its own tolerance was; one percent for the judge's rounding."""
        return self.error <= 1.01 * threshold


def parse_solve(row):
    """contact_skip/stack_10/newton/float64/cpu/threads:2/tolerance:1e-04/without:x as a Solve."""
    kind, problem, method, precision, _, *parts = row.name.split("/")
    named = dict(part.split(":", 1) for part in parts)
    return Solve(
        kind,
        problem,
        method,
        precision,
        int(named["threads"]),
        float(named["tolerance"]),
        named.get("visit", "first"),
        named.get("without", ""),
        named.get("coupling", "automatic"),
        row.time,
        row.low,
        row.high,
        row.contended,
        row["error"],
        row.counters,
    )


def read_solves(path):
    """(context, solves) of a results file; refused rows are left out."""
    context, rows = read_rows(path)
    return context, [parse_solve(row) for row in rows.values()]


def read_peers(path):
    """Solves of other solvers, of lines as

    FILE.hdf5 contacts N tol T ok sweeps N SOLVER ITS-OWN-ERROR fclib ERROR SECONDS s
    """
    solves = []
    with open(path, encoding="utf-8") as file:
        for match in filter(None, map(PEER_LINE.match, file)):
            counters = {key: float(match[key]) for key in ("contacts", "sweeps")}
            time = 1e3 * float(match["seconds"])
            solves.append(
                Solve(
                    problem=match["file"].removesuffix(".hdf5"),
                    method=match["solver"],
                    tolerance=float(match["tolerance"]),
                    time=time,
                    low=time,
                    high=time,
                    error=float(match["error"]),
                    counters=counters,
                )
            )
    return solves


def work_solves(solves):
    """Every method on every problem that all were tried on: first solves on all threads."""
    work = [s for s in solves if (s.kind, s.visit, s.without) == ("contact", "first", "")]
    most = max((s.threads for s in work), default=1)
    tried = {p: {s.method for s in work if s.problem == p} for p in {s.problem for s in work}}
    return [s for s in work if s.threads == most and len(tried[s.problem]) > 1]


def skip_bases(solves):
    """{(problem, method): solve} with every switch on."""
    return {(s.problem, s.method): s for s in solves if s.kind == "contact_skip" and not s.without}


def fastest(solves, threshold):
    """{(problem, method): solve} of the quickest that got there, float64."""
    best = {}
    for solve in solves:
        key = (solve.problem, solve.method)
        if solve.precision != "float64" or not solve.reaches(threshold):
            continue
        if key not in best or solve.time < best[key].time:
            best[key] = solve
    return best


def methods_of(solves):
    """Ours in a fixed order, then the others."""
    names = {solve.method for solve in solves}
    return [m for m in METHODS if m in names] + sorted(names.difference(METHODS))
