#!/usr/bin/env python3
"""Print the contact benchmark's results as Markdown: contact_table.py RESULTS.json [--peers FILE]"""
import argparse
import sys

from contact_rows import fastest, methods_of, read_peers, read_solves, skip_bases, work_solves
from rows import machine_of
from table import figure, table


def work_table(solves, threshold):
    """Milliseconds to a tolerance, and sweeps; a dash where the method does not get there."""
    best = fastest(solves, threshold)
    methods = methods_of(solves)
    contacts = {solve.problem: solve["contacts"] for solve in solves}
    lines = []
    for problem, count in contacts.items():
        cells = []
        for method in methods:
            solve = best.get((problem, method))
            note = " (busy machine)" if solve and solve.contended else ""
            cells.append(f"{figure(solve.time)} ({solve['sweeps']:.0f}){note}" if solve else "-")
        lines.append([problem, f"{count:.0f}"] + cells)
    return table(["problem", "contacts"] + [f"{m}, ms (sweeps)" for m in methods], lines)


def visit_table(solves):
    """First and following solves of the same structure."""
    visited = {s.problem for s in solves if s.visit != "first"}
    chosen = [
        s
        for s in solves
        if s.problem in visited
        and (s.kind, s.method, s.precision, s.tolerance) == ("contact", "automatic", "float64", 1e-4)
    ]
    lines = [
        [s.problem, f"{s['contacts']:.0f}", f"{s.threads}", s.visit, figure(s.time)]
        + [figure((s.high - s.low) / s.time * 100, 2) + " %", f"{s['sweeps']:.0f}"]
        + [f"{s['newton_iterations']:.0f}", figure(s.error, 2)]
        for s in sorted(chosen, key=lambda s: (s["contacts"], s.threads))
    ]
    header = ["problem", "contacts", "threads", "solve", "median ms", "quartile range", "sweeps"]
    return table(header + ["Newton iterations", "error"], lines)


def coupling_table(solves):
    """Elastic bodies: outer iterations from the start, or one factorization and fast sweeps."""
    lines = [
        [s.problem, f"{s.tolerance:.0e}", s.coupling, s.visit, figure(s.time)]
        + [f"{s['outer_iterations']:.0f}", f"{s['sweeps']:.0f}", figure(s.error, 2)]
        for s in solves
        if s.kind == "contact_coupling"
    ]
    header = ["problem", "tolerance", "coupling", "solve", "ms", "outer steps", "sweeps", "error"]
    return table(header, lines)


def skip_table(solves):
    lines = []
    bases = skip_bases(solves)
    for solve in solves:
        base = bases.get((solve.problem, solve.method))
        if solve.kind != "contact_skip" or not solve.without or base is None:
            continue
        saved = f"{100 * (1 - base.time / solve.time):.0f} %"
        updates = f"{solve['updates']:.0f}", f"{base['updates']:.0f}"
        lines.append(
            [solve.problem, solve.without, figure(solve.time), figure(base.time), saved, *updates]
        )
    header = ["problem", "without", "ms without", "ms with", "saved", "local solves without"]
    return table(header + ["local solves with"], lines)


def scale_table(solves):
    lines = [
        [f"{s['contacts']:.0f}", s.method, f"{s.threads}", figure(s.time), f"{s['sweeps']:.0f}"]
        + [figure(1e-6 * s["updates_per_second"]), "" if s["converged"] else "not converged"]
        for s in solves
        if s.kind == "contact_scale"
    ]
    header = ["contacts", "method", "threads", "ms to 1e-4", "sweeps"]
    return table(header + ["million contacts x sweeps / s", ""], lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results")
    parser.add_argument("--peers", help="lines of other solvers, see contact_rows.read_peers")
    arguments = parser.parse_args()
    context, solves = read_solves(arguments.results)
    work = work_solves(solves)
    known = {solve.problem for solve in work}
    peers = read_peers(arguments.peers) if arguments.peers else []
    work += [solve for solve in peers if solve.problem in known]
    print(machine_of(context) + "\n")
    sections = [(f"Time to {t:.0e}", work_table(work, t)) for t in (1e-4, 1e-8)]
    sections += [("First and following solves", visit_table(solves))]
    sections += [("Elastic bodies", coupling_table(solves))]
    sections += [("What skipping saves", skip_table(solves)), ("Size", scale_table(solves))]
    for title, lines in sections:
        print(f"### Contact: {title}\n\n" + "\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
