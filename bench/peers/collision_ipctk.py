#!/usr/bin/env python3
"""Compare tetwarp's times of touch with the tight-inclusion detection of ipctk, pair by pair.

    collision_ipctk.py PROGRAM [HITS RANDOM]

PROGRAM is tetwarp_collision_pairs, which makes HITS pairs of each of 12 kinds that meet by
construction, and RANDOM pairs, for vertex-face and edge-edge, and answers them. ipctk is asked
whether the features meet (distance 0), and of those that only tetwarp reports, whether they come
within the distance and slack of its answers. Pairs that meet in one plane are asked for the
distance of the answers instead of 0. Fails if tetwarp does not report a pair that ipctk finds to
meet, or a constructed one, or reports one that ipctk finds to stay beyond distance and slack. Exit
code 77: no ipctk.
"""
import os
import subprocess
import sys
import tempfile
import time

try:
    import ipctk
    import numpy
except ImportError as missing:
    print(f"skipped: {missing} (PyPI: ipctk, numpy)")
    sys.exit(77)

KINDS = ["generic", "tiny", "translation", "at_vertex", "at_edge", "grazing", "offset_1e3",
         "offset_1e6", "at_end", "coplanar_flat", "coplanar_tilted", "degenerate"]
ITERATIONS = 100000  # then ipctk reports a touch
# Asked whether they come within the distance of the answers instead: ipctk needs 0.2 s for a pair
# that meets in one plane, and minutes for some of them.
IN_PLANE = ["coplanar_flat", "coplanar_tilted", "degenerate"]


def ask(pairs, distances):
    """Times of touch by ipctk (2: none) and seconds per pair, calls included."""
    # A rescaling of 1 asks for `min_distance` itself, not for a part of the start's distance.
    times = numpy.full(len(pairs), 2.0)
    start = time.perf_counter()
    for k, (pair, distance) in enumerate(zip(pairs, distances)):
        tolerance = 1e-6 * pair[2]
        ccd = ipctk.TightInclusionCCD(tolerance, ITERATIONS, 1.0)
        function = ccd.edge_edge_ccd if pair[0] else ccd.point_triangle_ccd
        found, at = function(*pair[7:].reshape(8, 3), min_distance=distance)
        if found:
            times[k] = at
    return times, (time.perf_counter() - start) / max(1, len(pairs))


def call_cost():
    """Seconds of a call that has nothing to decide: the pair is far apart and at rest."""
    ccd = ipctk.TightInclusionCCD(1e-6, ITERATIONS, 1.0)
    points = numpy.eye(3)
    pair = [numpy.array([0.0, 0.0, 1e3]), *points] * 2
    start = time.perf_counter()
    for _ in range(2000):
        ccd.point_triangle_ccd(*pair, min_distance=0.0)
    return (time.perf_counter() - start) / 2000


def main():
    ipctk.set_logger_level(ipctk.LoggerLevel.error)
    program, hits, random = sys.argv[1], *(sys.argv[2:] or ["300", "46400"])
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "pairs.bin")
        costs = subprocess.run([program, path, hits, random], check=True, capture_output=True,
                               text=True).stdout
        pairs = numpy.fromfile(path).reshape(-1, 31)
    failures, total = 0, 0
    print(f"{'kind':16} {'features':12} pairs  ours  ipctk  missed  beyond  constructed missed: "
          "ours ipctk  us/pair ipctk")
    for edges in (0, 1):
        for number, name in [(-1, "random"), *enumerate(KINDS)]:
            some = pairs[(pairs[:, 0] == edges) & (pairs[:, 1] == number)]
            distances = some[:, 4] if name in IN_PLANE else numpy.zeros(len(some))
            meets, seconds = ask(some, distances)
            ours = some[:, 6] <= 1
            missed = int(numpy.sum((meets <= 1) & ~ours))
            more = some[ours & (meets > 1)]
            near, _ = ask(more, more[:, 4] + more[:, 5])
            beyond = int(numpy.sum(near > 1))
            made = some[:, 3] <= 1
            own = int(numpy.sum(made & ~(some[:, 6] <= some[:, 3])))
            # a grazing pair is 1e-12 apart: no meeting, but within the tolerance
            other = int(numpy.sum(made & (meets > some[:, 3] + 1e-9)))
            failures += missed + beyond + own
            total += len(some)
            print(f"{name:16} {'edge-edge' if edges else 'vertex-face':12} {len(some):5} "
                  f"{numpy.sum(ours):5} {numpy.sum(meets <= 1):6} {missed:7} {beyond:7} "
                  f"{own:25} {other:5} {1e6 * seconds:14.1f}", flush=True)
    print(costs + f"ipctk: {1e6 * call_cost():.1f} us of a call are Python's")
    print(f"{total} pairs compared, {failures} disagreements")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
