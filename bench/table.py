#!/usr/bin/env python3
"""Print a results file as Markdown tables."""
import argparse
import sys

from gpu_rows import PEERS, parse_peers, rows_with_peers
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


def pixels_of(row):
    return row.type if row.components == 1 else f"{row.components} x {row.type}"


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
            [row.workload, row.filter, pixels_of(row), where_of(row)]
            + [figure(row.time), spread_of(row)]
            + [floor, ratio, figure(row["ns_per_covered"]), figure(row["tests_per_covered"])]
            + [figure(row["max_error"], 2), figure(row["rms_error"], 2)]
        )
    header = ["workload", "filter", "pixels", "where", "median ms", "quartile range", "floor ms"]
    header += ["time / floor", "ns per covered voxel", "tests per covered voxel"]
    return table(header + ["max error", "RMS error"], lines)


def type_table(rows):
    """Filters, pixel types and components of one workload beside each other, each / float32."""
    groups = {}
    for row in rows:
        if row.kind == "warp" and not row.without:
            key = (row.workload, row.filter, row.components, where_of(row))
            groups.setdefault(key, {})[row.type] = row.time
    types = ("uint8", "int16", "float32", "float64")
    lines = []
    for (workload, filter_name, components, where), times in groups.items():
        if len(times) < 2:
            continue
        cells = []
        for name in types:
            ratio = times[name] / times["float32"] if {name, "float32"} <= times.keys() else 0
            note = f" ({ratio:.2f})" if ratio and name != "float32" else ""
            cells.append(figure(times[name]) + note if name in times else "")
        lines.append([workload, filter_name, str(components), where, *cells])
    header = ["workload", "filter", "components", "where"]
    return table(header + [f"{name}, ms" for name in types], lines)


def skip_table(rows):
    """What each switch saves; the step that has it on was timed in turn with the one without."""
    lines = [
        [row.workload, pixels_of(row), where_of(row), row.without]
        + [figure(row.time), figure(row["with"]), f"{round(100 * row['saved'])} %"]
        for row in rows
        if row.kind == "warp" and row.without
    ]
    header = ["workload", "pixels", "where", "without", "ms without", "ms with", "saved"]
    return table(header, lines)


def series_table(rows):
    lines = [
        [row.workload, where_of(row), f"{row.moved} %", f"{100 * row['tets_moved']:.1f} %"]
        + [f"{100 * row['cells_touched']:.1f} %", figure(row.time), figure(row["whole"])]
        + [f"{100 * row['cost_share']:.1f} %", f"{150 * row['cells_touched'] + 2:.1f} %"]
        for row in rows
        if row.kind == "series"
    ]
    header = ["workload", "where", "nodes moved", "tetrahedra moved", "cells touched"]
    header += ["ms of an update", "ms of a whole step", "cost", "1.5 x cells touched + 2 %"]
    return table(header, lines)


def overlap_table(rows):
    lines = [
        [row.workload, where_of(row), figure(row.time), figure(row["apart"])]
        + [f"{100 * row['cost_share']:.1f} %"]
        for row in rows
        if row.kind == "overlap"
    ]
    header = ["workload", "where", "ms of a step in flight with others", "ms of a step alone"]
    return table(header + ["cost"], lines)


def peer_table(rows, peers):
    """On the device without copies but for one column; the peers sample only, by a given map."""
    lines = [
        [row.workload, figure(row["kernel"]), figure(row["kernel_copies"]), figure(row["floor"])]
        + [figure(times["floor"])]
        + [figure(times[peer]) if peer in times else "" for peer in PEERS]
        for row, times in rows_with_peers(rows, peers)
    ]
    header = ["workload", "kernels, ms", "kernels and copies", "our sampling floor", "copy floor"]
    return table(header + ["PyTorch grid_sample", "CuPy affine_transform"], lines)


def region_table(rows):
    lines = [
        [row.workload, where_of(row), f"{100 * row['voxel_share']:.1f} %"]
        + [f"{100 * row['covered_share']:.1f} %", figure(row.time), figure(row["whole"])]
        + [f"{100 * row['cost_share']:.1f} %"]
        for row in rows
        if row.kind == "region"
    ]
    header = ["workload", "where", "voxels of the region", "covered voxels of the region"]
    return table(header + ["ms", "ms of the whole", "cost"], lines)


def chunk_table(rows):
    lines = [
        [row.workload, f"{100 * row['background_share']:.0f} %", figure(row.time)]
        + [figure(row["whole"]), figure(row["megabytes"]), figure(row["whole_megabytes"])]
        for row in rows
        if row.kind == "chunks"
    ]
    header = ["workload", "chunks of background", "ms to write", "ms with all chunks", "MB"]
    return table(header + ["MB with all"], lines)


def feature_table(rows):
    lines = [
        [row.workload, where_of(row), figure(row.time), figure(row["plain"])]
        + [figure(row["cost"], 2), figure(row["ns_per_covered"]), figure(row["max_error"], 2)]
        for row in rows
        if row.kind == "feature"
    ]
    header = ["feature", "where", "ms", "ms of the plain step", "cost", "ns per covered voxel"]
    return table(header + ["max error"], lines)


def field_table(rows):
    lines = [
        [row.workload, row.name.split("/")[2], figure(row.time), figure(row["plain"])]
        + [figure(row["field_ns_per_covered"])]
        for row in rows
        if row.kind == "fields"
    ]
    header = ["workload", "field", "ms with it", "ms without", "ns per covered voxel"]
    return table(header, lines)


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
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", help="what --benchmark_out wrote")
    parser.add_argument("--gpu-peers", metavar="FILE", help="see gpu_rows.py")
    arguments = parser.parse_args()
    context, rows = read_rows(arguments.results)
    rows = list(rows.values())
    print(machine_of(context) + "\n")
    sections = [
        ("Time", warp_table(rows)),
        ("Pixel types, in brackets: over float32", type_table(rows)),
        ("What skipping saves", skip_table(rows)),
        ("What updating saves", series_table(rows)),
        ("What overlapping steps saves", overlap_table(rows)),
        ("What a region costs", region_table(rows)),
        ("What chunks of background save", chunk_table(rows)),
        ("What features cost", feature_table(rows)),
        ("What fields cost", field_table(rows)),
        ("Error", error_table(rows)),
    ]
    if arguments.gpu_peers:
        with open(arguments.gpu_peers, encoding="utf-8") as file:
            device, peers = parse_peers(file.read())
        sections.append((f"Beside PyTorch and CuPy on {device}", peer_table(rows, peers)))
    for title, lines in sections:
        lines = list(lines)
        if len(lines) > 3:  # header, rule, empty line
            print(f"### {title}\n\n" + "\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
