"""Rows of a results file: what was measured, how long it took, how certain that is."""
import json
import re
from dataclasses import dataclass, field


@dataclass
class Row:
    """One benchmark. The parts of its name are fields, its counters a dictionary."""

    name: str
    kind: str = "warp"  # warp, or the first part of a name: series, feature, ...
    workload: str = ""
    filter: str = ""
    type: str = ""
    components: int = 1
    backend: str = ""
    threads: int = 0
    without: str = ""
    moved: int = 0  # percent of the nodes, in a series
    time: float = 0.0  # median [ms]
    low: float = 0.0  # lower and upper quartile [ms]
    high: float = 0.0
    contended: bool = False
    counters: dict = field(default_factory=dict)

    def __getitem__(self, counter):
        return self.counters[counter]


def parse_name(name):
    """W2_rotated_256/linear/float32/cpu/threads:2/without:culling as a Row without figures."""
    row = Row(name)
    parts = name.split("/")
    kinds = ("analytic", "position", "series", "overlap", "region", "chunks", "labels", "feature",
             "fields")
    if parts[0] in kinds:
        row.kind = parts.pop(0)
    row.workload = parts.pop(0)
    for part in parts:
        if part in ("nearest", "linear", "cubic", "bspline", "lanczos", "labels"):
            row.filter = part
        elif part in ("cpu", "cuda", "reference"):
            row.backend = part
        elif part.startswith("threads:"):
            row.threads = int(part.split(":")[1])
        elif part.startswith("without:"):
            row.without = part.split(":")[1]
        elif part.startswith("moved:"):
            row.moved = int(part.split(":")[1])
        elif match := re.fullmatch(r"(u?int\d+|float\d+)(?:x(\d+))?", part):
            row.type, row.components = match[1], int(match[2] or 1)
    return row


def parse_rows(results):
    """Rows by name of a parsed results file; refused rows are left out."""
    rows = {}
    scale = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}
    for entry in results["benchmarks"]:
        if entry.get("error_occurred") or entry.get("run_type") == "aggregate":
            continue
        name = entry["run_name"].replace("/iterations:1", "").replace("/manual_time", "")
        row = parse_name(name)
        row.time = entry["real_time"] * scale[entry["time_unit"]]
        row.low = entry.get("low", row.time)
        row.high = entry.get("high", row.time)
        row.contended = bool(entry.get("contended", 0))
        row.counters = {k: v for k, v in entry.items() if isinstance(v, (int, float))}
        rows[name] = row
    return rows


def place_of(row):
    """Sorts by kind, then workloads by the numbers in their names; else as measured."""
    parts = row.workload.split("_")
    return row.kind, [(part.isdigit(), int(part) if part.isdigit() else part) for part in parts]


def read_rows(path):
    """(context, rows by name) of a results file, in the order of place_of()."""
    with open(path, encoding="utf-8") as file:
        results = json.load(file)
    rows = parse_rows(results)
    return results["context"], {row.name: row for row in sorted(rows.values(), key=place_of)}


def machine_of(context):
    """One line on where and from what the figures come."""
    keys = ("processor", "vectors", "threads", "device", "compiler", "commit")
    known = [f"{key} {context[key]}" for key in keys if key in context]
    return ", ".join([context["date"][:10]] + known)
