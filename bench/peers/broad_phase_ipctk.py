"""Broad phases of IPC Toolkit on the piles that tetwarp_bench_collide --export=FOLDER writes.

Usage: broad_phase_ipctk.py FILE... ; prints a line per file and method: threads, milliseconds (median),
candidates of vertices and faces, candidates of edges. All pairs of features that share no vertex
count, those of one body included, as in the rows with self:1; swept boxes are inflated by the
distance that the detector looks for.
"""

import statistics
import sys
import time

import ipctk
import numpy

THICKNESS = 1e-5
REPETITIONS = 5


def read(path):
    with open(path, "rb") as file:
        vertices, edges, triangles = numpy.fromfile(file, numpy.int64, 3)
        start = numpy.fromfile(file, numpy.float64, 3 * vertices).reshape(-1, 3)
        end = numpy.fromfile(file, numpy.float64, 3 * vertices).reshape(-1, 3)
        edges = numpy.fromfile(file, numpy.int32, 2 * edges).reshape(-1, 2)
        triangles = numpy.fromfile(file, numpy.int32, 3 * triangles).reshape(-1, 3)
    return [numpy.asfortranarray(array) for array in (start, end, edges, triangles)]


def measure(method, mesh, start, end):
    times = []
    for _ in range(REPETITIONS):
        candidates = ipctk.Candidates()
        before = time.perf_counter()
        candidates.build(mesh, start, end, THICKNESS, method())
        times.append(1e3 * (time.perf_counter() - before))
    return statistics.median(times), candidates


def main(paths):
    for path in paths:
        start, end, edges, triangles = read(path)
        mesh = ipctk.CollisionMesh(start, edges, triangles)
        for method in (ipctk.HashGrid, ipctk.LBVH, ipctk.SweepAndPrune):
            for threads in (1, 2):
                ipctk.set_num_threads(threads)
                milliseconds, found = measure(method, mesh, start, end)
                print(f"{path} {method.__name__} threads {threads}: {milliseconds:.1f} ms, "
                      f"{len(found.fv_candidates)} vertex-face, {len(found.ee_candidates)} edge-edge",
                      flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
