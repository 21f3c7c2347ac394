"""The scenes of contact_scenes.py in tetwarp.

Usage: contact_scenes_tetwarp.py COMMAND, where COMMAND is the program tetwarp.
"""

import json
import pathlib
import resource
import subprocess
import sys
import tempfile

import h5py
import numpy

import contact_scenes as c

PLANE = {"name": "plane", "plane": {"normal": [0, 0, 1], "point": [0, 0, 0]}}
GAP = 1e-5  # of bodies at rest: the thickness


def cube(name, density, height, **more):
    return {"name": name, "kind": "rigid", "shape": {"type": "box", "half": [c.SIDE / 2] * 3},
            "density": density, "pose": {"position": [0, 0, height]}, **more}


def seconds_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def simulate(command, document, path):
    """Seconds of the processor."""
    (path / "scene.json").write_text(json.dumps(document))
    before = seconds_of_children()
    subprocess.run([command, "simulate", path / "scene.json", "-o", path / "out",
                    "--threads", "1"], check=True, stdout=subprocess.DEVNULL)
    return seconds_of_children() - before


def run(command, scene, bodies, obstacle):
    """Places of the nodes of all bodies after each step, and milliseconds a step, without files."""
    document = {"tetwarp_scene": 1, "time_step": c.STEP, "gravity": [0, 0, -c.GRAVITY],
                "contact": {"friction": c.FRICTION}, "obstacles": [obstacle], "bodies": bodies,
                "thickness": GAP if scene != "drape" else 1e-3}
    steps = round(c.DURATION[scene] / c.STEP)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        one, all_steps = (simulate(command, document | {"duration": c.STEP * count,
                                                        "output": {"every": steps}}, path)
                          for count in (1, steps))
        milliseconds = 1e3 * (all_steps - one) / (steps - 1)
        simulate(command, document | {"duration": c.DURATION[scene], "output": {"every": 1}}, path)
        places = []
        for body in bodies:
            with h5py.File(path / "out" / f"{body['name']}.vtkhdf") as file:
                group = file["VTKHDF"]
                count = int(group["NumberOfPoints"][0])
                ways = group["PointData/displacement"][:].reshape(-1, count, 3)
                places.append(group["Points"][:count] + ways)
                cells = group["Connectivity"][:] if body["kind"] == "cloth" else None
    return places, cells, milliseconds


def in_order(places, center):
    """Corners in the order of contact_scenes.CORNERS."""
    wanted = c.cube_at(center)
    nearest = [numpy.linalg.norm(places[0] - corner, axis=1).argmin() for corner in wanted]
    return places[:, nearest]


def main(command):
    volume = c.SIDE**3
    height = c.SIDE / 2 + GAP
    thrown = cube("cube", 1 / volume, height, velocity=[c.SPEED, 0, 0])
    places, _, milliseconds = run(command, "thrown", [thrown], PLANE)
    c.report_thrown("tetwarp", in_order(places[0], [0, 0, height]), milliseconds)

    heights = [height + n * (c.SIDE + GAP) for n in range(len(c.MASSES))]
    stack = [cube(f"cube{n}", mass / volume, at)
             for n, (mass, at) in enumerate(zip(c.MASSES, heights))]
    places, _, milliseconds = run(command, "stack", stack, PLANE)
    cubes = [in_order(own, [0, 0, at]) for own, at in zip(places, heights)]
    c.report_stack("tetwarp", list(zip(*cubes)), milliseconds)

    sheet = {"name": "sheet", "kind": "cloth", "self": False,
             "sheet": {"size": [1, 1], "cells": [c.CELLS] * 2, "axes": [[1, 0, 0], [0, 1, 0]],
                       "origin": [-0.5, -0.5, c.RADIUS + 0.02]},
             "areal_density": c.AREAL_DENSITY, "stretch": c.STRETCH, "shear": 80, "bend": 2e-4,
             "damping": {"alpha": 0.2, "gamma": 0.002}}
    ball = {"name": "ball", "sphere": {"centre": [0, 0, 0], "radius": c.RADIUS}}
    places, cells, milliseconds = run(command, "drape", [sheet], ball)
    c.report_drape("tetwarp", places[0], cells.reshape(-1, 3), milliseconds)


main(sys.argv[1])
