"""Plots of the warp benchmark's rows."""
from chart import Chart, bars, use_logarithms

STAGES = ("upload", "setup", "mask", "cull", "raster", "download")
TYPES = ("uint8", "int16", "float32", "float64")


def main_rows(rows, backend, threads):
    """Linear, float32, all threads."""
    return [
        row
        for row in rows
        if row.kind == "warp"
        and (row.method, row.type, row.backend) == ("linear", "float32", backend)
        and row.components == 1
        and row.threads in (0, threads)
    ]


def threads_of(rows):
    return max((row.threads for row in rows), default=1)


def draw_line(axis, points, **style):
    if points:
        axis.plot(*zip(*sorted(points)), marker="o", **style)


def culling_lines(axis, rows, x_of):
    """Time with and without culling, and the sampling floor, for each back end."""
    for backend in ("cpu", "cuda"):
        chosen = main_rows(rows, backend, threads_of(rows))
        for without, label in (("", "with culling"), ("culling", "without culling")):
            points = [(x_of(row), row.time) for row in chosen if row.without == without]
            style = "-" if not without else "--"
            draw_line(axis, points, linestyle=style, label=f"{backend}, {label}")
        floors = [(x_of(r), r["floor"]) for r in chosen if not r.without and "floor" in r.counters]
        draw_line(axis, floors, linestyle=":", color="gray", label=f"{backend}, sampling floor")


def draw_work_precision(rows, folder):
    title = "Work against precision: image of at most 4 waves per volume, turned by 45° twice"
    x = ("largest error / range", "RMS error / range")
    with Chart(folder, "work_precision", title, x, "ns per covered voxel", columns=2) as chart:
        chart.legend = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)}
        for color, type_name in enumerate(TYPES):
            styles = {"nearest": "--", "linear": "-", "cubic": "-.", "bspline": ":"}
            styles["lanczos"] = (0, (5, 1, 1, 1, 1, 1))
            for filter_name, style in styles.items():
                points = [
                    (int(row.workload), row)
                    for row in rows
                    if (row.kind, row.type, row.method) == ("analytic", type_name, filter_name)
                ]
                points = [row for _, row in sorted(points, key=lambda point: point[0])]
                for axis, key in zip(chart.axes, ("max_error", "rms_error")):
                    use_logarithms(axis)
                    if not points:
                        continue
                    errors = [row[key] for row in points]
                    times = [row["ns_per_covered"] for row in points]
                    label = f"{filter_name}, {type_name}"
                    axis.plot(
                        errors, times, linestyle=style, marker="o", color=f"C{color}", label=label
                    )
                    if type_name != "float32":
                        continue
                    for row, at in zip(points, zip(errors, times)):
                        place = {"xytext": (6, 2), "textcoords": "offset points"}
                        axis.annotate(f"{row.workload}³", at, fontsize=7, **place)


def draw_tets(rows, folder):
    chosen = [row for row in rows if row.workload.startswith("W3_waved_256_")]
    chosen = [row for row in chosen if row.workload.count("_") == 3]
    title = "Time against tetrahedra, 256³ voxels, waves"
    with Chart(folder, "time_against_fineness", title, "tetrahedra", "ms") as chart:
        use_logarithms(chart.axes[0])
        culling_lines(chart.axes[0], chosen, lambda row: row["tets"])


def draw_threads(rows, folder):
    with Chart(folder, "speed_up", "Speed-up over threads", "threads", "speed-up") as chart:
        chosen = [row for row in rows if row.kind == "warp" and row.backend == "cpu"]
        chosen = [row for row in chosen if row.type == "float32" and row.method == "linear"]
        chosen = [row for row in chosen if not row.without and row.components == 1]
        for name in sorted({row.workload for row in chosen}):
            mine = {row.threads: row.time for row in chosen if row.workload == name}
            if 1 in mine and len(mine) > 1:
                points = [(threads, mine[1] / time) for threads, time in mine.items()]
                draw_line(chart.axes[0], points, label=name)
        if chart.axes[0].has_data():
            most = threads_of(chosen)
            chart.axes[0].plot((1, most), (1, most), ":", color="gray", label="ideal")
            chart.axes[0].set_xticks(sorted({row.threads for row in chosen}))


def draw_stages(rows, folder):
    chosen = [r for b in ("cpu", "cuda") for r in main_rows(rows, b, threads_of(rows))]
    chosen = [row for row in chosen if not row.without]
    title = "Share of each stage"
    with Chart(folder, "stages", title, "% of a step", "") as chart:
        left = [0.0] * len(chosen)
        for stage in STAGES:
            shares = [100 * row[stage] / row["mean"] for row in chosen]
            if any(share > 0 for share in shares):
                chart.axes[0].barh(range(len(chosen)), shares, left=left, label=stage)
                left = [a + b for a, b in zip(left, shares)]
        bars(chart, [f"{row.workload}, {row.backend}" for row in chosen])


def draw_floors(rows, folder):
    chosen = [row for row in rows if row.kind == "warp" and not row.without]
    chosen = [row for row in chosen if "floor_ratio" in row.counters]
    chosen = [row for row in chosen if row.threads == threads_of(rows)]
    title = "Time over the sampling floor (one affine map, no tetrahedra)"
    with Chart(folder, "floor_ratio", title, "time / floor", "") as chart:
        ratios = [row["floor_ratio"] for row in chosen]
        chart.axes[0].barh(range(len(chosen)), ratios, label="warp")
        chart.axes[0].axvline(1, linestyle=":", color="black", label="floor")
        bars(chart, [f"{row.workload}, {row.method}, {row.type}" for row in chosen])


def draw(rows, folder):
    for draw_one in (
        draw_work_precision, draw_tets, draw_threads, draw_stages, draw_floors
    ):
        draw_one(rows, folder)
