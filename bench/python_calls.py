#!/usr/bin/env python3
"""What a call of the Python package takes beyond the library, on a cubic image.

    PYTHONPATH=build/release/python python3 bench/python_calls.py [VOXELS_PER_SIDE]

`call` is the whole call; `python` the same with a Warper of the module that does nothing, so that
what is left runs in Python: microseconds of the processor. `module` is the time of a step in the
module beyond the total in the library's report, which other work on the machine lengthens; the dict
of a result's report is not made. `point` is transform_points of one point, and the same in the
module; `simulator` is a step of the scenes `top` and `chain`, and the same in the module. All are the
least of 300 calls, of 20 from 128 voxels per side on, each after 4 MiB of other memory were written,
as a warp does. Arrays that a step writes are given.
"""

import json
import sys
import time

import numpy as np

import tetwarp
from tetwarp import _core

SIZE = int(sys.argv[1]) if len(sys.argv) > 1 else 64
RUNS = 300 if SIZE < 128 else 20


class Nothing:
    """In place of the module's Warper."""

    def __init__(self, *_, **__):
        pass

    def step(self, *_):
        return {}


def least(call):
    """Least of call(), which returns microseconds."""
    other = np.ones(4 << 20, np.uint8)
    results = []
    for _ in range(RUNS):
        other[::64] += 1
        results.append(call())
    return round(min(results), 1)


def timed(call):
    start = time.process_time_ns()
    call()
    return (time.process_time_ns() - start) / 1e3


def steps_of(scene):
    simulator = tetwarp.Simulator(tetwarp.shipped_scene(scene), threads=1)
    return {"call": least(lambda: timed(simulator.step)),
            "module": least(lambda: timed(lambda: simulator._simulator.step(None)))}


def main():
    volume = tetwarp.phantom(shape=(SIZE, SIZE, SIZE))
    mesh = tetwarp.lattice_mesh(volume, cells=6, threshold=0.1)
    deformed = tetwarp.deform(*mesh, amount=0.5)
    out = np.empty_like(volume.array)
    options = dict(threads=1, backend="cpu")
    affine = volume.affine
    warper = tetwarp.Warper(volume, *mesh, **options)
    inner = warper._warper

    def beyond_total():
        start = time.perf_counter_ns()
        report = inner.step(deformed, [out], {}, 0, None)
        passed = time.perf_counter_ns() - start
        return passed / 1e3 - 1e6 * report.dict()["timings"]["total"]

    module = least(beyond_total)
    step = least(lambda: timed(lambda: warper(deformed, out=out)))
    whole = least(lambda: timed(
        lambda: tetwarp.warp(volume, *mesh, deformed, out=out, **options)))
    warper._warper, kept = Nothing(), _core.Warper
    _core.Warper = Nothing
    python = {
        "step": least(lambda: timed(lambda: warper(deformed, out=out))),
        "warp": least(lambda: timed(
            lambda: tetwarp.warp(volume, *mesh, deformed, out=out, **options))),
        "warp of an array": least(lambda: timed(
            lambda: tetwarp.warp(volume.array, *mesh, deformed, out=out, affine=affine, **options))),
    }
    _core.Warper = kept
    cells = (mesh.cells, np.empty((0, 8), np.int32), np.empty((0, 6), np.int32))
    point = mesh.points.mean(axis=0, keepdims=True)
    points = {
        "call": least(lambda: timed(lambda: tetwarp.transform_points(point, *mesh, deformed))),
        "module": least(lambda: timed(lambda: _core.map_points(
            point, None, mesh.points, *cells, deformed, False))),
    }
    print(json.dumps({"voxels": SIZE**3, "nodes": len(mesh.points), "python": python,
                      "module": {"step": module}, "call": {"step": step, "warp": whole},
                      "point": points, "simulator": {n: steps_of(n) for n in ("top", "chain")}}))


if __name__ == "__main__":
    main()
