"""Rows of results files: what was measured, how long it took, which counters it has."""
import json
import re
from dataclasses import dataclass, field

KINDS = ("analytic", "position", "series", "overlap", "resident", "copies", "staging", "paper",
         "region", "chunks", "labels", "feature", "fields", "contact", "contact_skip", "contact_scale",
         "contact_coupling", "contact_method")
METHODS = ("automatic", "newton", "anderson", "nonlinear_cg", "gauss_seidel")
MILLISECONDS = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}


@dataclass
class Row:
    """One benchmark. The parts of its name are fields, its counters a dictionary."""

    name: str = ""
    kind: str = "warp"  # warp, or one of KINDS
    workload: str = ""  # of the contact benchmark: the problem
    method: str = ""  # filter of a warp, method of a contact solver, name of a field
    type: str = "float64"  # of pixels or of the contact solver's numbers
    components: int = 1
    backend: str = ""
    threads: int = 0
    without: str = ""  # the switch that is off
    moved: int = 0  # percent of the nodes, in a series
    tolerance: float = 0.0
    visit: str = "first"  # which solve: first, kept or warm
    rule: str = "parallel"  # how friction and adhesion combine
    coupling: str = "automatic"  # of elastic bodies: automatic, iterated or condensed
    time: float = 0.0  # median [ms]
    low: float = 0.0  # lower and upper quartile [ms]
    high: float = 0.0
    contended: bool = False  # too few repetitions had their processors
    counters: dict = field(default_factory=dict)

    def __getitem__(self, counter):
        return self.counters[counter]

    def reaches(self, threshold):
        """The error is within a threshold, whatever the row's own tolerance; 1 % for rounding."""
        return self["error"] <= 1.01 * threshold


def parse_name(name):
    """W2_rotated_256/linear/float32/cpu/threads:2/without:culling as a Row without figures."""
    row = Row(name)
    parts = name.split("/")
    if parts[0] in KINDS:
        row.kind = parts.pop(0)
    row.workload = parts.pop(0)
    for part in parts:
        key, _, value = part.partition(":")
        if value:
            setattr(row, key, type(getattr(row, key))(value))
        elif part in ("cpu", "cuda", "reference"):
            row.backend = part
        elif match := re.fullmatch(r"(u?int\d+|float\d+)(?:x(\d+))?", part):
            row.type, row.components = match[1], int(match[2] or 1)
        else:
            row.method = part
    return row


def parse_rows(results):
    """Rows by name of a parsed results file; refused rows are left out."""
    rows = {}
    for entry in results["benchmarks"]:
        if entry.get("error_occurred") or entry.get("run_type") == "aggregate":
            continue
        name = entry["run_name"].replace("/iterations:1", "").replace("/manual_time", "")
        row = parse_name(name)
        row.time = entry["real_time"] * MILLISECONDS[entry["time_unit"]]
        row.low = entry.get("low", row.time)
        row.high = entry.get("high", row.time)
        row.contended = bool(entry.get("contended", 0))
        row.counters = {k: v for k, v in entry.items() if isinstance(v, (int, float))}
        rows[name] = row
    return rows


def place_of(row):
    """Sorts by kind, warps also by the numbers in the workload's name; else as measured."""
    parts = [] if row.kind.startswith("contact") else row.workload.split("_")
    return row.kind, [(part.isdigit(), int(part) if part.isdigit() else part) for part in parts]


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def read_rows(path):
    """(context, rows by name) of a results file, in the order of place_of()."""
    results = read_json(path)
    rows = parse_rows(results)
    return results["context"], {row.name: row for row in sorted(rows.values(), key=place_of)}


def is_contact(rows):
    return any(row.kind.startswith("contact") for row in rows)


def machine_of(context):
    """One line: date, machine, compiler and commit of the figures."""
    keys = ("processor", "vectors", "threads", "device", "compiler", "commit")
    known = [f"{key} {context[key]}" for key in keys if key in context]
    return ", ".join([context["date"][:10]] + known)


def work_solves(solves):
    """First solves on all threads of the problems that several methods were tried on."""
    work = [s for s in solves if (s.kind, s.visit, s.without) == ("contact", "first", "")]
    most = max((s.threads for s in work), default=1)
    tried = {p: {s.method for s in work if s.workload == p} for p in {s.workload for s in work}}
    return [s for s in work if s.threads == most and len(tried[s.workload]) > 1]


def skip_bases(solves):
    """{(problem, method): solve} with every switch on."""
    chosen = [s for s in solves if s.kind == "contact_skip" and not s.without]
    return {(s.workload, s.method): s for s in chosen}


def fastest(solves, threshold):
    """{(problem, method): solve} of the quickest float64 solve within an error."""
    best = {}
    for solve in solves:
        key = (solve.workload, solve.method)
        if solve.type != "float64" or not solve.reaches(threshold):
            continue
        if key not in best or solve.time < best[key].time:
            best[key] = solve
    return best


def methods_of(solves):
    """Our methods in a fixed order, then the other solvers."""
    names = {solve.method for solve in solves}
    return [m for m in METHODS if m in names] + sorted(names.difference(METHODS))


def self_test():
    parsed = parse_name("W2_rotated_256/linear/float32/cpu/threads:2/without:culling")
    fields = (parsed.kind, parsed.workload, parsed.method, parsed.type, parsed.backend)
    assert fields == ("warp", "W2_rotated_256", "linear", "float32", "cpu"), fields
    assert (parsed.threads, parsed.without) == (2, "culling"), parsed
    parsed = parse_name("W1_torso_700/linear/uint8x3/cpu/threads:2")
    assert (parsed.type, parsed.components) == ("uint8", 3), parsed
    parsed = parse_name("contact/slab_151/newton/float32/cpu/threads:2/tolerance:1e-04/visit:kept")
    fields = (parsed.kind, parsed.workload, parsed.method, parsed.type)
    assert fields == ("contact", "slab_151", "newton", "float32"), fields
    assert (parsed.tolerance, parsed.visit, parsed.coupling) == (1e-4, "kept", "automatic"), parsed
