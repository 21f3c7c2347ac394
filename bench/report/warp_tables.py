"""Markdown tables of the warp benchmark's rows."""


def table(columns, rows):
    """Lines of a Markdown table: columns are (header, text of a row); empty without rows."""
    rows = list(rows)
    if not rows:
        return []
    lines = [[header for header, _ in columns], None]
    lines += [[text(row) for _, text in columns] for row in rows]
    rule = "|" + "---|" * len(columns)
    return ["| " + " | ".join(line) + " |" if line else rule for line in lines] + [""]


def figure(value, digits=3):
    return f"{value:.{digits}g}" if value < 1000 else f"{value:,.0f}"


def counter(header, key, digits=3):
    """A column; empty where a row lacks the counter."""
    return header, lambda row: figure(row[key], digits) if key in row.counters else ""


def percent(header, key, digits=1):
    return header, lambda row: f"{100 * row[key]:.{digits}f} %"


def where_of(row):
    return f"{row.backend}, {row.threads} threads" if row.threads else row.backend


def pixels_of(row):
    return row.type if row.components == 1 else f"{row.components} x {row.type}"


def spread_of(row):
    note = " (busy machine)" if row.contended else ""
    return f"{figure((row.high - row.low) / row.time * 100, 2)} %{note}"


WORKLOAD = ("workload", lambda row: row.workload)
PIXELS = ("pixels", pixels_of)
WHERE = ("where", where_of)


def ms(header):
    return header, lambda row: figure(row.time)


def kind_tables():
    """(title, kind, columns) of the tables that list all rows of one kind."""
    limit = "1.5 x cells touched + 2 %"
    alone = "ms of a step alone"
    return [
        ("What updating saves", "series", [
            WORKLOAD, WHERE, ("nodes moved", lambda row: f"{row.moved} %"),
            percent("tetrahedra moved", "tets_moved"), percent("cells touched", "cells_touched"),
            ms("ms of an update"), counter("ms of a whole step", "whole"),
            percent("cost", "cost_share"),
            (limit, lambda row: f"{150 * row['cells_touched'] + 2:.1f} %")]),
        ("What overlapping steps saves", "overlap", [
            WORKLOAD, WHERE, ms("ms of a step in flight with others"), counter(alone, "apart"),
            percent("cost", "cost_share")]),
        ("What results in memory of the host cost", "copies", [
            WORKLOAD, ms("ms into pageable memory"), counter("page-locked", "locked"),
            counter("of the device", "resident"), counter("GB/s pageable", "rate"),
            counter("GB/s page-locked", "locked_rate"), percent("share", "rate_share", 0),
            counter("first step", "first_step"), counter("construction", "construct"),
            counter("page-locking", "lock")]),
        ("Copies of pageable memory by a ring", "staging", [
            ("direction, MiB", lambda row: row.workload), ("slots x MiB", lambda row: row.method),
            ("threads", lambda row: str(row.threads)), ms("ms"), counter("GB/s", "rate"),
            counter("by the runtime", "runtime_rate"), counter("page-locked", "locked_rate"),
            percent("share", "rate_share", 0)]),
        ("What a region costs", "region", [
            WORKLOAD, WHERE, percent("voxels of the region", "voxel_share"),
            percent("covered voxels of the region", "covered_share"), ms("ms"),
            counter("ms of the whole", "whole"), percent("cost", "cost_share")]),
        ("What chunks of background save", "chunks", [
            WORKLOAD, percent("chunks of background", "background_share", 0), ms("ms to write"),
            counter("ms with all chunks", "whole"), counter("MB", "megabytes"),
            counter("MB with all", "whole_megabytes")]),
        ("What features cost", "feature", [
            ("feature", lambda row: row.workload), WHERE, ms("ms"),
            counter("ms of the plain step", "plain"), counter("cost", "cost", 2),
            counter("ns per covered voxel", "ns_per_covered"),
            counter("max error", "max_error", 2)]),
        ("What fields cost", "fields", [
            WORKLOAD, ("field", lambda row: row.method), ms("ms with it"),
            counter("ms without", "plain"),
            counter("ns per covered voxel", "field_ns_per_covered")]),
    ]


def step_table(rows):
    columns = [WORKLOAD, ("filter", lambda row: row.method), PIXELS, WHERE, ms("median ms"),
               ("quartile range", spread_of), counter("floor ms", "floor"),
               counter("time / floor", "floor_ratio"),
               counter("ns per covered voxel", "ns_per_covered"),
               counter("tests per covered voxel", "tests_per_covered"),
               counter("max error", "max_error", 2), counter("RMS error", "rms_error", 2)]
    return table(columns, (row for row in rows if row.kind == "warp" and not row.without))


def type_table(rows):
    """Pixel types beside each other, each with its ratio to float32."""
    groups = {}
    for row in rows:
        if row.kind == "warp" and not row.without:
            key = (row.workload, row.method, row.components, where_of(row))
            groups.setdefault(key, {})[row.type] = row.time

    def time_of(name):
        def text(group):
            times = group[1]
            if name not in times:
                return ""
            ratio = times[name] / times["float32"] if "float32" in times else 0
            note = f" ({ratio:.2f})" if ratio and name != "float32" else ""
            return figure(times[name]) + note

        return f"{name}, ms", text

    headers = ("workload", "filter", "components", "where")
    columns = [(name, lambda group, at=at: str(group[0][at])) for at, name in enumerate(headers)]
    columns += [time_of(name) for name in ("uint8", "int16", "float32", "float64")]
    return table(columns, (group for group in groups.items() if len(group[1]) > 1))


def skip_table(rows):
    """What each switch saves; both steps were timed in turn."""
    columns = [WORKLOAD, PIXELS, WHERE, ("without", lambda row: row.without), ms("ms without"),
               counter("ms with", "with"), ("saved", lambda row: f"{round(100 * row['saved'])} %")]
    return table(columns, (row for row in rows if row.kind == "warp" and row.without))


def error_table(rows):
    """Errors of interpolation; results up to 2026-11-21 also have errors of positions."""

    def either(header, analytic, position):
        return header, lambda row: figure(row[analytic if row.kind == "analytic" else position], 2)

    def wrong(row):
        keys = ("holes", "painted", "doubles")
        return f"{sum(row[key] for key in keys):.0f}" if row.kind == "position" else ""

    columns = [("error of", lambda row: row.kind), ("workload or n", lambda row: row.workload),
               ("filter", lambda row: row.method), ("pixels", lambda row: row.type),
               either("max", "max_error", "position_max"),
               either("RMS", "rms_error", "position_rms"),
               ("unit", lambda row: "voxel" if row.kind == "position" else "range"),
               ("voxels wrongly covered", wrong)]
    return table(columns, (row for row in rows if row.kind in ("analytic", "position")))


def sampler_table(rows, peers):
    """On a device, without copies except in one column; the other programs only sample."""

    def peer(header, key):
        times = lambda row: peers[row.workload]
        return header, lambda row: figure(times(row)[key]) if key in times(row) else ""

    key = ("warp", "cuda", "linear", "float32", 1, "")
    chosen = [row for row in rows if row.workload in peers
              and (row.kind, row.backend, row.method, row.type, row.components, row.without) == key]
    columns = [WORKLOAD, counter("kernels, ms", "kernel"),
               counter("kernels and copies", "kernel_copies"),
               counter("our sampling floor", "floor"), peer("copy floor", "floor"),
               peer("PyTorch grid_sample", "torch"), peer("CuPy affine_transform", "cupy")]
    return table(columns, chosen)


def beside_table(results):
    """A file of tetwarp_bench_peers: medians of its rounds, all programs in one process."""

    def middle(times):
        return sorted(times)[len(times) // 2]

    def time(header, key):
        def text(row):
            value = row.get(key)
            return "" if value is None else figure(middle(value) if key in rounds else value)

        return header, text

    def over_floor(row):
        return f"{middle(row['tetwarp_ms']) / middle(row['floor_ms']):.2f}"

    rounds = ("floor_ms", "tetwarp_ms")
    columns = [("workload", lambda row: row["workload"]),
               ("tetrahedra", lambda row: f"{row['tetrahedra']:,}"), time("tetwarp", "tetwarp_ms"),
               ("over floor", over_floor),
               time("floor", "floor_ms"), time("probe", "scanline_probe_ms"),
               time("paper's method", "paper_method_ms"), time("VTK", "vtk_locator_ms"),
               time("ITK", "itk_warp_dense_field_given_ms")]
    return table(columns, results["rows"])


def sections(rows):
    """(title, lines) of all tables that have rows."""
    tables = [("Time", step_table(rows)),
              ("Pixel types, in brackets: over float32", type_table(rows)),
              ("What skipping saves", skip_table(rows))]
    for title, kind, columns in kind_tables():
        tables.append((title, table(columns, (row for row in rows if row.kind == kind))))
    tables.append(("Error", error_table(rows)))
    return tables
