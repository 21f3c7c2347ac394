"""The cantilever in tetwarp: corotational linear tetrahedra, five per cell.

Usage: cantilever_tetwarp.py COMMAND [CELLS ...], where COMMAND is the program tetwarp.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy

import cantilever as c

STEP = 0.005


def scene(nu, cells):
    beam = {
        "name": "beam", "kind": "fem",
        "shape": {"type": "box", "half": [c.LENGTH / 2, c.WIDTH / 2, c.WIDTH / 2]},
        "lattice": {"cells": [10 * cells, cells, cells]},
        "material": {"E": c.YOUNG, "nu": nu, "density": c.DENSITY},
        "damping": {"alpha": c.DAMPING, "gamma": 0},
        "fixed": {"half_space": [-1, 0, 0, c.LENGTH / 2 - 1e-4]},
    }
    return {"tetwarp_scene": 1, "time_step": STEP, "duration": c.DURATION,
            "gravity": [0, 0, -c.GRAVITY], "bodies": [beam], "output": {"every": 4}}


def run(command, nu, cells):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        (path / "beam.json").write_text(json.dumps(scene(nu, cells)))
        subprocess.run([command, "simulate", path / "beam.json", "-o", path / "out", "--threads", "1"],
                       check=True, stdout=subprocess.DEVNULL)
        with h5py.File(path / "out" / "series.h5") as series:
            milliseconds = 1e3 * numpy.mean(series["seconds/total"][1:])
        with h5py.File(path / "out" / "beam.vtkhdf") as file:
            group = file["VTKHDF"]
            count = int(group["NumberOfPoints"][0])
            points = group["Points"][:count]
            ways = group["PointData/displacement"][:].reshape(-1, count, 3)
            times = group["Steps/Values"][:]
    tip = points[:, 0] > points[:, 0].max() - 1e-6
    c.report("tetwarp", nu, cells, STEP, milliseconds, times, -ways[:, tip, 2].mean(axis=1))


for argument in sys.argv[2:] or ["1", "2", "4"]:
    for poisson in (0.0, 0.3):
        run(sys.argv[1], poisson, int(argument))
