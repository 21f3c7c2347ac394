#!/usr/bin/env python3
"""Contact problems without adhesion in `tetwarp contact` and in Siconos, at equal FCLIB error.

For every file and error: tetwarp on one thread and on two, solved in turn, and Siconos' NSGS,
nonsmooth Newton and ADMM on one thread. The tolerance of each Siconos solver is lowered from 100
times the error until the FCLIB error of its impulses, computed here, is small enough: the time of
the loosest tolerance that reaches it counts. Prints two Markdown tables:

  least times in ms, sweeps or iterations in parentheses; a dash: not reached, with the smallest
  FCLIB error; "limit": ended by --seconds; "crash": Siconos ended its process
  tetwarp with two threads over one: the median ratio of neighboring solves, and the ratio of minima

tetwarp's times contain checks and structure; Siconos gets W in sparse blocks, made beforehand.
Needs python3-siconos, python3-h5py, python3-scipy. Nothing else may run meanwhile.
"""
import argparse
import json
import multiprocessing
import os
import statistics
import subprocess
import sys
import tempfile

import h5py

import siconos_nsgs

SOLVERS = {"NSGS": "NSGS", "Newton": "NSN_AC", "ADMM": "ADMM"}
FACTORS = (100, 30, 10, 3, 1, 0.3, 0.1, 0.01)  # of the error: tolerances tried, in this order


class Problem:
    def __init__(self, path, folder):
        self.path, self.name = path, os.path.basename(path).removesuffix(".hdf5")
        self.w, self.q, self.friction = siconos_nsgs.read_local(path)
        self.file = os.path.join(folder, self.name + ".dat")
        with open(self.file, "w", encoding="ascii") as file:
            siconos_nsgs.write_blocks(file, self.w, self.q, self.friction)

    def error(self, impulse):
        velocity = self.w @ impulse + self.q
        return siconos_nsgs.fclib_error(self.q, self.friction, impulse, velocity)


def run_child(connection, arguments):
    sink = os.open(os.devnull, os.O_WRONLY)
    os.dup2(sink, 1)
    connection.send(siconos_nsgs.solve(*arguments))


def solve_in_child(arguments, limit):
    """What siconos_nsgs.solve() returns, or "limit" or "crash"."""
    ours, theirs = multiprocessing.Pipe(duplex=False)
    child = multiprocessing.Process(target=run_child, args=(theirs, arguments))
    child.start()
    theirs.close()
    result = "limit"
    if ours.poll(limit):
        try:
            result = ours.recv()
        except EOFError:
            result = "crash"
    child.kill()
    child.join()
    return result


def siconos_cell(problem, solver, error, options):
    """Text of one Siconos solver: the loosest tolerance whose result has this FCLIB error."""
    least = float("inf")
    for factor in FACTORS:
        arguments = (problem.file, len(problem.q), factor * error, options.max_sweeps,
                     SOLVERS[solver])
        result = solve_in_child(arguments, options.seconds)
        if isinstance(result, str):
            return result
        _, sweeps, _, impulse, seconds = result
        reached = problem.error(impulse)
        if reached == reached:
            least = min(least, reached)
        if reached <= error:
            for _ in range(options.rounds - 1):
                again = solve_in_child(arguments, options.seconds)
                if not isinstance(again, str):
                    seconds = min(seconds, again[4])
            return f"{1e3 * seconds:.3g} ({sweeps})"
    return f"- ({least:.0e})"


def solve_by_tetwarp(problem, error, threads, options, folder):
    """(milliseconds, FCLIB error, sweeps, Newton steps) of one run of the command."""
    output, report = os.path.join(folder, "solved.hdf5"), os.path.join(folder, "report.json")
    for path in (output, report):
        if os.path.exists(path):
            os.remove(path)
    subprocess.run([options.command, "contact", problem.path, "-o", output, "--measure", "fclib",
                    "--tolerance", str(error), "--threads", str(threads), "--report", report,
                    "--quiet"], check=False)
    with open(report, encoding="utf-8") as file:
        numbers = json.load(file)
    with h5py.File(output, "r") as file:
        impulse = file["solution/r"][()].ravel()
    time = 1e3 * (numbers["timings"]["setup"] + numbers["timings"]["solve"])
    return time, problem.error(impulse), numbers["sweeps"], numbers["newton_iterations"]


def tetwarp_cells(problem, error, options, folder):
    """(text of the solve on one thread, row of two threads beside one)."""
    times = {1: [], 2: []}
    for _ in range(options.rounds):
        for threads, own in times.items():
            time, reached, sweeps, newton = solve_by_tetwarp(problem, error, threads, options,
                                                             folder)
            own.append(time)
    ratio = statistics.median(two / one for one, two in zip(times[1], times[2]))
    least = min(times[2]) / min(times[1])
    beside = (problem.name, f"{error:.0e}", f"{min(times[1]):.3g}", f"{min(times[2]):.3g}",
              f"{ratio:.2f}", f"{least:.2f}")
    if reached > 1.01 * error:
        return f"- ({reached:.0e})", beside
    return f"{min(times[1]):.3g} ({sweeps}" + (f", {newton} Newton)" if newton else ")"), beside


def print_table(header, rows):
    for cells in (header, ["---"] * len(header), *rows):
        print("| " + " | ".join(cells) + " |")
    print(flush=True)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("command", help="the command tetwarp")
    parser.add_argument("files", nargs="+", metavar="FILE.hdf5")
    parser.add_argument("--error", type=float, nargs="*", default=[1e-4, 1e-8])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=60, help="limit of a Siconos solve")
    parser.add_argument("--max-sweeps", type=int, default=20000)
    parser.add_argument("--solvers", nargs="*", choices=sorted(SOLVERS), default=list(SOLVERS))
    options = parser.parse_args()
    times, threads = [], []
    with tempfile.TemporaryDirectory() as folder:
        for path in options.files:
            problem = Problem(path, folder)
            for error in options.error:
                own, beside = tetwarp_cells(problem, error, options, folder)
                others = [siconos_cell(problem, s, error, options) for s in options.solvers]
                times.append((problem.name, str(len(problem.friction)), f"{error:.0e}", own,
                              *others))
                threads.append(beside)
                print("  ".join(times[-1]), " threads", *beside[2:], file=sys.stderr, flush=True)
    print_table(["problem", "contacts", "error", "tetwarp",
                 *("Siconos " + s for s in options.solvers)], times)
    print_table(["problem", "error", "1 thread, ms", "2 threads, ms", "median ratio",
                 "ratio of minima"], threads)


if __name__ == "__main__":
    main()
