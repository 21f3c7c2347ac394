#!/usr/bin/env python3
"""Print a results file as Markdown tables: table.py RESULTS.json"""
import sys

from rows import machine_of, read_rows


def table(header, lines):
    yield "| " + " | ".join(header) + " |"
    yield "|" + "---|" * len(header)
    for line in lines:
        yield "| " + " | ".join(line) + " |"
    yield ""


def figure(value, digits=3):
    return f"{value:.{digits}g}" if value < 1000 else f"{value:,.0f}"


def where_of(row):
    return f"{row.backend}, {row.threads} threads" if row.threads else row.backend


def spread_of(row):
    note = " (busy machine)" if row.contended else ""
    return f"{figure((row.high - row.low) / row.time * 100, 2)} %{note}"


def warp_table(rows):
    lines = []
    for row in rows:
        if row.kind != "warp" or row.without:
            continue
        floor = figure(row["floor"]) if "floor" in row.counters else ""
        ratio = figure(row["floor_ratio"]) if "floor" in row.counters else ""
        lines.append(
            [row.workload, row.filter, row.type, where_of(row), figure(row.time), spread_of(row)]
            + [floor, ratio, figure(row["ns_per_covered"]), figure(row["tests_per_covered"])]
            + [figure(row["max_error"], 2), figure(row["rms_error"], 2)]
        )
    header = ["workload", "filter", "pixels", "where", "median ms", "quartile range", "floor ms"]
    header += ["time / floor", "ns per covered voxel", "tests per covered voxel"]
    return table(header + ["max error", "RMS error"], lines)


def skip_table(rows):
    """What each switch saves: the row with everything on beside the row without it."""
    by_name = {row.name: row for row in rows}
    lines = []
    for row in rows:
        base = by_name.get(row.name.rsplit("/without:", 1)[0])
        if row.kind != "warp" or not row.without or base is None:
            continue
        saved = 1 - base.time / row.time
        lines.append(
            [row.workload, row.type, where_of(row), row.without]
            + [figure(row.time), figure(base.time), f"{100 * saved:.0f} %"]
        )
    header = ["workload", "pixels", "where", "without", "ms without", "ms with", "saved"]
    return table(header, lines)


def series_table(rows):
    lines = [
        [row.workload, where_of(row), f"{row.moved} %", f"{100 * row['tets_moved']:.1f} %"]
        + [f"{100 * row['cells_touched']:.1f} %", figure(row.time), figure(row["whole"])]
        + [f"{100 * row['cost_share']:.1f} %"]
        for row in rows
        if row.kind == "series"
    ]
    header = ["workload", "where", "nodes moved", "tetrahedra moved", "cells touched"]
    return table(header + ["ms of an update", "ms of a whole step", "cost"], lines)


def error_table(rows):
    lines = []
    for row in rows:
        if row.kind == "analytic":
            error = [figure(row["max_error"], 2), figure(row["rms_error"], 2), ""]
        elif row.kind == "position":
            wrong = row["holes"] + row["painted"] + row["doubles"]
            error = [figure(row["position_max"], 2), figure(row["position_rms"], 2), f"{wrong:.0f}"]
        else:
            continue
        unit = "voxel" if row.kind == "position" else "range"
        lines.append([row.kind, row.workload, row.filter, row.type, *error[:2], unit, error[2]])
    header = ["error of", "workload or n", "filter", "pixels", "max", "RMS", "unit"]
    return table(header + ["voxels wrongly covered"], lines)


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    context, rows = read_rows(sys.argv[1])
    rows = list(rows.values())
    print(machine_of(context) + "\n")
    sections = [("Time", warp_table(rows)), ("What skipping saves", skip_table(rows))]
    sections += [("What updating saves", series_table(rows)), ("Error", error_table(rows))]
    for title, lines in sections:
        print(f"### {title}\n\n" + "\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
