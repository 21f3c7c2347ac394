"""The two figures of the paper: time against volume size and against tetrahedra."""
import re

import rows

#: (kind, backend): (label, color)
METHODS = {
    ("warp", "cpu"): ("tetwarp", "C0"),
    ("resident", "cuda"): ("tetwarp", "C1"),
    ("paper", "cpu"): ("paper's method", "C2"),
    ("paper", "cuda"): ("paper's method", "C3"),
}
WITHOUT = {"culling": "without culling", "cells": "without cells"}
SIZES = re.compile(r"W2_rotated_(\d+)")
TETS = re.compile(r"W2_rotated_384(?:_\d+)?")


def place_of(context, backend):
    """Where rows of a file ran, for the legend."""
    if backend == "cuda":
        return context["device"]
    return f"{context['threads']} threads of {context['processor']}".replace("(R)", "")


def chosen_rows(found):
    """Rows of both methods, float32 and linear, on a device or all threads."""
    most = max((row.threads for row in found), default=0)
    return [
        row
        for row in found
        if (row.kind, row.backend) in METHODS
        and (row.method, row.type, row.components) == ("linear", "float32", 1)
        and row.threads in (0, most)
        and row.without in ("", *WITHOUT)
    ]


def time_of(row):
    """Of a row whose processors were busy elsewhere the processor time of a thread [ms]."""
    if row.contended and row.threads:
        return row.time * row["busy"] / row.threads
    return row.time


def in_words(count):
    return f"{count / 1e6:.3g} M" if count >= 1e6 else f"{count:,.0f}"


def lines_of(files, pattern, counter):
    """{(label, color, style): [(counter, ms)]} of the rows whose workload matches.

    files : (context, rows) of results files
    """
    lines = {}
    for context, found in files:
        for row in chosen_rows(found):
            if not pattern.fullmatch(row.workload) or counter not in row.counters:
                continue
            name, color = METHODS[row.kind, row.backend]
            label = f"{name}, {place_of(context, row.backend)}"
            if row.without:
                label += f", {WITHOUT[row.without]}"
            points = lines.setdefault((label, color, "--" if row.without else "-"), [])
            points.append((row[counter], time_of(row)))
    return {key: sorted(points) for key, points in lines.items()}


def draw(files, folder):
    from chart import Chart, use_logarithms

    Chart.machine = "\n".join(rows.machine_of(context) for context, _ in files)
    for name, title, x, pattern, counter in (
        ("time_against_size", "1,080 tetrahedra, turned by 45° twice; 128³ to 512³ samples",
         "output voxels", SIZES, "voxels"),
        ("time_against_tetrahedra", "384³ samples turned by 45° twice; 234 million output voxels",
         "tetrahedra", TETS, "tets"),
    ):
        with Chart(folder, name, title, x, "ms") as chart:
            chart.legend = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.13)}
            chart.figure.set_size_inches(7, 6.4)
            axis = chart.axes[0]
            use_logarithms(axis)
            lines = lines_of(files, pattern, counter)
            for (label, color, style), points in sorted(lines.items()):
                axis.plot(*zip(*points), style, marker="o", color=color, label=label)
            places = sorted({x for points in lines.values() for x, _ in points})
            axis.set_xticks(places, [in_words(x) for x in places])
            axis.set_xticks([], minor=True)


def table(files):
    """Markdown: the paper's shares of voxels that pass, and times beside it."""
    from warp_tables import figure
    from warp_tables import table as lines_of_table

    merged = {}
    for _, found in files:
        for row in chosen_rows(found):
            merged.setdefault(row.workload, {})[row.kind, row.backend, row.without] = row
    chosen = [item for item in merged.items() if ("paper", "cpu", "") in item[1]]

    def time(kind, backend, without=""):
        key = (kind, backend, without)
        return lambda item: figure(time_of(item[1][key])) if key in item[1] else ""

    def share(without, counter):
        key = ("paper", "cpu", without)
        return lambda item: f"{100 * item[1][key][counter]:.1f} %" if key in item[1] else ""

    columns = [
        ("workload", lambda item: item[0]),
        ("voxels pass, without cells", share("cells", "pass_share")),
        ("with cells", share("", "pass_share")),
        ("cells culled", share("", "culled_share")),
        ("cpu: paper, without cells", time("paper", "cpu", "cells")),
        ("paper", time("paper", "cpu")),
        ("tetwarp", time("warp", "cpu")),
        ("device: paper, without cells", time("paper", "cuda", "cells")),
        ("paper", time("paper", "cuda")),
        ("tetwarp", time("resident", "cuda")),
    ]
    return lines_of_table(columns, chosen)


def self_test():
    context = {"date": "2026-01-01", "processor": "P", "threads": "2", "device": "D"}
    results = {"benchmarks": [
        {"run_name": name + "/iterations:1/manual_time", "real_time": time, "time_unit": "ms",
         "voxels": voxels, "tets": tets, "pass_share": 0.5, "culled_share": 0.6,
         "busy": 0.5, "contended": float(name.endswith("_40/linear/float32/cpu/threads:2"))}
        for name, time, voxels, tets in (
            ("W2_rotated_256/linear/float32/cpu/threads:2", 3, 64, 1080),
            ("W2_rotated_256/linear/float32/cpu/threads:1", 5, 64, 1080),
            ("W2_rotated_128/linear/float32/cpu/threads:2", 1, 8, 1080),
            ("W2_rotated_384_40/linear/float32/cpu/threads:2", 9, 216, 40),
            ("paper/W2_rotated_384/linear/float32/cuda", 2, 216, 1080),
            ("paper/W2_rotated_256/linear/float32/cpu/threads:2", 7, 64, 1080),
            ("paper/W2_rotated_256/linear/float32/cpu/threads:2/without:cells", 9, 64, 1080))]}
    files = [(context, list(rows.parse_rows(results).values()))]
    assert lines_of(files, SIZES, "voxels") == {
        ("tetwarp, 2 threads of P", "C0", "-"): [(8, 1), (64, 3)],
        ("paper's method, D", "C3", "-"): [(216, 2)],
        ("paper's method, 2 threads of P", "C2", "-"): [(64, 7)],
        ("paper's method, 2 threads of P, without cells", "C2", "--"): [(64, 9)],
    }, lines_of(files, SIZES, "voxels")
    assert lines_of(files, TETS, "tets") == {
        ("tetwarp, 2 threads of P", "C0", "-"): [(40, 2.25)],
        ("paper's method, D", "C3", "-"): [(1080, 2)],
    }
    line = "| W2_rotated_256 | 50.0 % | 50.0 % | 60.0 % | 9 | 7 | 3 |  |  |  |"
    assert table(files)[2] == line, table(files)
