"""Compares the solvers of contacts on recorded problems.

    python compare_solvers.py [PROBLEM ...]

Problems are files of the FCLIB format, as `tetwarp contact` and other programs write them. Without
one a stack of ten boxes that is pushed sideways is written first, as stack.hdf5.
"""

import sys
import time

import numpy as np

import tetwarp

METHODS = ("auto", "gs", "anderson", "nncg", "newton")


def stack(count=10):
    """Boxes of 1 kg on each other: the lowest touches the floor. A contact per pair, u = W r + q."""
    delassus = np.zeros((3 * count, 3 * count))
    for above in range(count):  # body `above` lies on body `above - 1`, or on the floor
        rows = slice(3 * above, 3 * above + 3)
        delassus[rows, rows] += np.eye(3)
        if above > 0:
            under = slice(3 * above - 3, 3 * above)
            delassus[rows, rows] += np.eye(3)
            delassus[rows, under] -= np.eye(3)
            delassus[under, rows] -= np.eye(3)
    free = np.zeros((count, 3))
    free[0] = -0.05, 0.02, 0  # the others fall and slide as fast: their contacts stay as they are
    return tetwarp.ContactProblem(
        delassus=delassus, free_velocity=free.ravel(), friction=np.full(count, 0.6))


def main():
    paths = sys.argv[1:]
    if not paths:
        paths = ["stack.hdf5"]
        tetwarp.write(paths[0], stack())
    problems = [tetwarp.read(path) for path in paths]
    for path, problem in zip(paths, problems):
        print(path)
        for method in METHODS:
            start = time.perf_counter()
            solution = tetwarp.solve_contacts(problem, method=method, tolerance=1e-8)
            seconds = time.perf_counter() - start
            print(f"  {method:8} {solution.status}, eta {solution.report['residual']:.1e}, "
                  f"{solution.report['sweeps']} sweeps, {1e3 * seconds:.2f} ms")
    return problems


if __name__ == "__main__":
    main()
