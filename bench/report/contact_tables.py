"""Markdown tables of the contact benchmark's rows."""
from rows import fastest, methods_of, skip_bases, work_solves
from warp_tables import counter, figure, ms, table

PROBLEM = ("problem", lambda solve: solve.workload)


def count(header, key):
    return header, lambda solve: f"{solve[key]:.0f}"


def work_table(solves, threshold):
    """Milliseconds and sweeps to a tolerance; a dash where a method does not reach it."""
    best = fastest(solves, threshold)

    def method(name):
        def text(problem):
            solve = best.get((problem[0], name))
            note = " (busy machine)" if solve and solve.contended else ""
            return f"{figure(solve.time)} ({solve['sweeps']:.0f}){note}" if solve else "-"

        return f"{name}, ms (sweeps)", text

    contacts = {solve.workload: solve["contacts"] for solve in solves}
    columns = [("problem", lambda problem: problem[0]),
               ("contacts", lambda problem: f"{problem[1]:.0f}")]
    return table(columns + [method(name) for name in methods_of(solves)], contacts.items())


def visit_table(solves):
    """First and following solves of the same structure."""
    visited = {s.workload for s in solves if s.visit != "first"}
    key = ("contact", "automatic", "float64", 1e-4)
    chosen = [s for s in solves
              if s.workload in visited and (s.kind, s.method, s.type, s.tolerance) == key]
    spread = lambda s: figure((s.high - s.low) / s.time * 100, 2) + " %"
    columns = [PROBLEM, count("contacts", "contacts"), ("threads", lambda s: f"{s.threads}"),
               ("solve", lambda s: s.visit), ms("median ms"), ("quartile range", spread),
               count("sweeps", "sweeps"), count("Newton iterations", "newton_iterations"),
               counter("error", "error", 2)]
    return table(columns, sorted(chosen, key=lambda s: (s["contacts"], s.threads)))


def coupling_table(solves):
    """Elastic bodies: iterated from the start, or condensed by one factorization."""
    columns = [PROBLEM, ("tolerance", lambda s: f"{s.tolerance:.0e}"),
               ("coupling", lambda s: s.coupling), ("solve", lambda s: s.visit), ms("ms"),
               count("outer steps", "outer_iterations"), count("sweeps", "sweeps"),
               counter("error", "error", 2)]
    return table(columns, (s for s in solves if s.kind == "contact_coupling"))


def skip_table(solves):
    bases = skip_bases(solves)
    base = lambda s: bases[s.workload, s.method]
    chosen = [s for s in solves if s.kind == "contact_skip" and s.without
              and (s.workload, s.method) in bases]
    columns = [PROBLEM, ("without", lambda s: s.without), ms("ms without"),
               ("ms with", lambda s: figure(base(s).time)),
               ("saved", lambda s: f"{100 * (1 - base(s).time / s.time):.0f} %"),
               count("local solves without", "updates"),
               ("local solves with", lambda s: f"{base(s)['updates']:.0f}")]
    return table(columns, chosen)


def scale_table(solves):
    rate = lambda s: figure(1e-6 * s["updates_per_second"])
    columns = [count("contacts", "contacts"), ("method", lambda s: s.method),
               ("threads", lambda s: f"{s.threads}"), ms("ms to 1e-4"), count("sweeps", "sweeps"),
               ("million contacts x sweeps / s", rate),
               ("", lambda s: "" if s["converged"] else "not converged")]
    return table(columns, (s for s in solves if s.kind == "contact_scale"))


def method_table(solves):
    """Processor time, sweeps (or outer iterations) and Newton steps of every method on one thread."""
    lines = {}
    for solve in (s for s in solves if s.kind == "contact_method"):
        lines.setdefault((solve.workload, solve.rule, solve.tolerance), {})[solve.method] = solve
    names = methods_of([solve for line in lines.values() for solve in line.values()])
    reached = lambda line: {name: s for name, s in line.items() if s["converged"]}

    def method(name):
        def text(item):
            solve = reached(item[1]).get(name)
            if not solve:
                return "-"
            steps = f"{solve['outer_iterations'] or solve['sweeps']:.0f}"
            if solve["newton_iterations"]:
                steps += f" + {solve['newton_iterations']:.0f}"
            return f"{figure(solve['processor'])} ({steps})"

        return name, text

    def over_best(item):
        times = {name: solve["processor"] for name, solve in reached(item[1]).items()}
        own = times.pop("automatic", None)
        return f"{own / min(times.values()):.2f}" if own and times else ""

    def residual(item):
        solve = item[1].get("automatic")
        return figure(solve["eta"], 2) if solve else ""

    anyone = lambda item: next(iter(item[1].values()))
    columns = [("problem", lambda item: item[0][0] + (", restrictive" if item[0][1] != "parallel" else "")),
               ("contacts", lambda item: f"{anyone(item)['contacts']:.0f}"),
               ("to eta", lambda item: f"{item[0][2]:.0e}")]
    columns += [method(name) for name in names]
    columns += [("eta of automatic", residual), ("over best", over_best)]
    return table(columns, lines.items())


def sections(solves, peers):
    """(title, lines) of all tables that have rows. Other solvers join the work tables."""
    work = work_solves(solves)
    known = {solve.workload for solve in work}
    work += [solve for solve in peers if solve.workload in known]
    tables = [(f"Time to {t:.0e}", work_table(work, t)) for t in (1e-4, 1e-8)]
    tables += [("First and following solves", visit_table(solves)),
               ("Elastic bodies", coupling_table(solves)),
               ("What skipping saves", skip_table(solves)), ("Size", scale_table(solves)),
               ("Methods, ms of a processor (sweeps + Newton steps)", method_table(solves))]
    return [("Contact: " + title, lines) for title, lines in tables]
