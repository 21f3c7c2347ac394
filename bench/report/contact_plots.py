"""Plots of the contact benchmark's rows."""
from chart import Chart, bars
from rows import METHODS, fastest, methods_of, skip_bases, work_solves


def color_of(method):
    return f"C{METHODS.index(method)}" if method in METHODS else "black"


def draw_work_precision(solves, folder):
    """One picture per problem; hollow marks where the tolerance was not reached."""
    for problem in dict.fromkeys(solve.workload for solve in solves):
        mine = [solve for solve in solves if solve.workload == problem and solve["error"] > 0]
        contacts = f"{mine[0]['contacts']:.0f} contacts" if mine else ""
        name = "contact_work_precision_" + problem
        with Chart(folder, name, f"{problem}, {contacts}", "ms", "error reached") as chart:
            axis = chart.axes[0]
            axis.set_xscale("log")
            axis.set_yscale("log")
            chart.legend = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)}
            for method in methods_of(mine):
                for precision, style in (("float64", "-"), ("float32", "--")):
                    line = [s for s in mine if (s.method, s.type) == (method, precision)]
                    line.sort(key=lambda solve: -solve.tolerance)
                    if not line:
                        continue
                    label = method + (", float32" if precision == "float32" else "")
                    times, errors = [s.time for s in line], [s["error"] for s in line]
                    color = color_of(method)
                    axis.plot(times, errors, style, color=color, label=label)
                    fills = [color if s.reaches(s.tolerance) else "white" for s in line]
                    axis.scatter(times, errors, s=24, c=fills, edgecolors=color, zorder=3)


def draw_profile(solves, folder, name, title):
    """Dolan and More 2002: the share of problems solved within a factor of the quickest method."""
    problems = {solve.workload for solve in solves}
    x = tuple(f"time / quickest, to error {threshold:.0e}" for threshold in (1e-4, 1e-8))
    title = f"{title}: {len(problems)} problems"
    with Chart(folder, name, title, x, "share of problems solved", columns=2) as chart:
        for axis, threshold in zip(chart.axes, (1e-4, 1e-8)):
            best = fastest(solves, threshold)
            quickest = {
                p: min(solve.time for (problem, _), solve in best.items() if problem == p)
                for p in {problem for problem, _ in best}
            }
            ratios = {
                method: sorted(
                    best[p, method].time / t for p, t in quickest.items() if (p, method) in best
                )
                for method in methods_of(solves)
            }
            end = 2 * max((r[-1] for r in ratios.values() if r), default=1)
            for method, steps in ratios.items():
                shares = [k / len(problems) for k in range(len(steps) + 1)]
                width = 4 if method == "automatic" else 1.5  # stays visible below an equal line
                axis.step([1, *steps, end], [*shares, shares[-1]], where="post",
                          color=color_of(method), label=method, linewidth=width)
            axis.set_xscale("log")
            axis.set_ylim(0, 1.02)


def draw_profiles(work, peers, folder):
    tried = {p: {s.method for s in work if s.workload == p} for p in {s.workload for s in work}}
    most = max(map(len, tried.values()), default=0)
    by_all = [solve for solve in work if len(tried[solve.workload]) == most]
    draw_profile(by_all, folder, "contact_profile", "Performance profile, float64")
    shared = {solve.workload for solve in peers}
    if shared:
        both = [solve for solve in work if solve.workload in shared]
        known = {solve.workload for solve in both}
        both += [solve for solve in peers if solve.workload in known]
        draw_profile(both, folder, "contact_profile_peers", "Beside other solvers, float64")


def draw_scale(solves, folder):
    chosen = [solve for solve in solves if solve.kind == "contact_scale"]
    for name, counter, y in (
        ("contact_time_against_size", None, "ms to 1e-4"),
        ("contact_rate_against_size", "updates_per_second", "contacts x sweeps per second"),
    ):
        with Chart(folder, name, "Packings of spheres", "contacts", y) as chart:
            axis = chart.axes[0]
            axis.set_xscale("log")
            axis.set_yscale("log")
            for key in dict.fromkeys((solve.method, solve.threads) for solve in chosen):
                line = [s for s in chosen if (s.method, s.threads) == key and s["converged"]]
                points = [(s["contacts"], s[counter] if counter else s.time) for s in line]
                if points:
                    method, threads = key
                    axis.plot(*zip(*sorted(points)), "--" if threads == 1 else "-", marker="o",
                              color=color_of(method), label=f"{method}, {threads} threads")


def draw_skips(solves, folder):
    chosen = [solve for solve in solves if solve.kind == "contact_skip"]
    bases = skip_bases(chosen)
    chosen = [s for s in chosen if s.without and (s.workload, s.method) in bases]
    title = "Time with one switch off over time with all on"
    with Chart(folder, "contact_skips", title, "time without / time with", "") as chart:
        ratios = [s.time / bases[s.workload, s.method].time for s in chosen]
        chart.axes[0].barh(range(len(chosen)), ratios)
        chart.axes[0].axvline(1, linestyle=":", color="black", label="nothing saved")
        bars(chart, [f"{s.workload}, {s.without}" for s in chosen])


def draw(solves, peers, folder):
    work = work_solves(solves)
    known = {solve.workload for solve in work}
    draw_work_precision(work + [s for s in peers if s.workload in known], folder)
    draw_profiles(work, peers, folder)
    draw_scale(solves, folder)
    draw_skips(solves, folder)
