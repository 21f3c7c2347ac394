"""Hard scenes of small size through the command: whether steps converge, stay apart and end, and what
they cost.

    python3 bench/simulate/stress.py build/release/tetwarp FOLDER [--steps N]

prints a table of all scenes, writes it to FOLDER/stress.csv and draws FOLDER/stress.png. Needs h5py
and matplotlib.
"""
import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile

import h5py

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "report"))
from chart import Chart  # noqa: E402


def block(name, half, cells, position, young, **more):
    return {"name": name, "kind": "fem", "shape": {"type": "box", "half": half},
            "lattice": {"cells": cells}, "pose": {"position": position},
            "material": {"E": young, "nu": 0.4, "density": 1000}, **more}


def scene_of(bodies, time_step, **more):
    return {"tetwarp_scene": 1, "time_step": time_step, "duration": 1, "thickness": 1e-4,
            "contact": {"friction": 0.3}, "bodies": bodies,
            "obstacles": [{"name": "floor", "plane": {"normal": [0, 0, 1], "point": [0, 0, 0]}}],
            **more}


def two_blocks(low, high, time_step=4e-3, speed=0.5, friction=0.3, offset=0.0):
    """A block of stiffness `low` [Pa] on the floor and one of stiffness `high` that falls on it."""
    soft = block("soft", [0.05, 0.05, 0.03], [2, 2, 1], [offset, offset, 0.0305 + offset], low)
    hard = block("hard", [0.03, 0.03, 0.03], [2, 2, 2], [0.01 + offset, offset, 0.0915 + offset],
                 high, velocity=[0.2, 0, -speed])
    scene = scene_of([soft, hard], time_step, contact={"friction": friction})
    scene["obstacles"][0]["plane"]["point"] = [offset, offset, offset]
    return scene


def squeezed(kind, young):
    """A body between the floor and a lid that leaves no room."""
    body = block("body", [0.05, 0.05, 0.05], [2, 2, 2], [0, 0, 0.0505], young)
    if kind == "rigid":
        body = {"name": "body", "kind": "rigid", "density": 1000, "shape": {"type": "box", "half": [0.05] * 3},
                "pose": {"position": [0, 0, 0.0505]}}
    lid = {"name": "lid", "kind": "scripted", "shape": {"type": "box", "half": [0.1, 0.1, 0.01]},
           "lattice": {"cells": [1, 1, 1]}, "pose": {"position": [0, 0, 0.12]},
           "path": [[0, 0, 0, 0], [0.1, 0, 0, -0.06]]}
    return scene_of([body, lid], 5e-3)


def resting_cloth(cells):
    """A contact per vertex."""
    cloth = {"name": "cloth", "kind": "cloth",
             "sheet": {"size": [1, 1], "cells": [cells, cells], "origin": [0, 0, 1.5e-4],
                       "axes": [[1, 0, 0], [0, 1, 0]]},
             "areal_density": 0.3, "stretch": 400, "shear": 80, "bend": 2e-4}
    return scene_of([cloth], 4e-3)


def gravel(side, layers):
    """Turned cubes of 1 cm that fall on the floor and on each other."""
    bodies = []
    for n in range(side * side * layers):
        i, j, k = n % side, n // side % side, n // side**2
        bodies.append({
            "name": f"stone{n}", "kind": "rigid", "density": 2500,
            "shape": {"type": "box", "half": [0.005] * 3},
            "pose": {"position": [0.018 * i, 0.018 * j, 0.0095 + 0.018 * k],
                     "axis_angle": [0.7 * ((7 * n) % 5 - 2), 0.7 * ((11 * n) % 7 - 3), n % 3]}})
    return scene_of(bodies, 4e-3)


def cases():
    for ratio in (1, 1e2, 1e4, 1e6):
        yield "stiffness", f"E x {ratio:g} above", two_blocks(1e4, 1e4 * ratio)
        yield "stiffness", f"E x {ratio:g} below", two_blocks(1e4 * ratio, 1e4)
    for time_step in (1e-4, 1e-3, 5e-3, 2e-2, 5e-2):
        yield "time step", f"dt {1e3 * time_step:g} ms", two_blocks(3e4, 1e6, time_step)
    for speed in (1, 10, 50):
        yield "speed", f"{speed} m/s", two_blocks(3e4, 1e5, speed=speed)
    for friction in (0, 1, 1000):
        yield "friction", f"friction {friction}", two_blocks(3e4, 1e6, friction=friction)
    yield "offset", "offset 1e6 m", two_blocks(3e4, 1e5, offset=1e6)
    yield "squeezed", "squeezed, E 3e4", squeezed("fem", 3e4)
    yield "squeezed", "squeezed, rigid", squeezed("rigid", 0)
    yield "size", "cloth of 100,489 nodes", resting_cloth(316)
    yield "size", "1,352 stones", gravel(13, 8)


def run(command, name, scene, steps):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "scene.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(scene, file)
        done = subprocess.run(
            [command, "simulate", path, "-o", os.path.join(folder, "out"), "--steps", str(steps),
             "--threads", "1", "--quiet"], capture_output=True, text=True, timeout=3600, check=False)
        if done.returncode not in (0, 3):
            sys.exit(f"{name}: {done.stderr.strip()}")
        with h5py.File(os.path.join(folder, "out", "series.h5"), "r") as series:
            after = {key: series[key][1:] for key in (
                "converged", "clamped_islands", "substeps", "contacts", "contact_passes",
                "smallest_distance", "inverted", "seconds/total", "energy/total")}
    return {
        "scene": name,
        "converged": float((after["converged"] != 0).mean()),
        "clamped": float((after["clamped_islands"] > 0).mean()),
        "divided": float((after["substeps"] > 1).mean()),
        "parts": int(after["substeps"].max()),
        "passes": float(after["contact_passes"].mean()),
        "contacts": int(after["contacts"].max()),
        "distance": float(after["smallest_distance"].min() / scene["thickness"]),
        "inverted": int(after["inverted"].max()),
        "finite": bool((abs(after["energy/total"]) < 1e300).all()),
        "ms": 1e3 * float(after["seconds/total"].mean()),
    }


def draw(rows, folder, steps):
    with Chart(folder, "stress", f"Hard scenes, {steps} steps each, the last two 24",
               ("share of steps", "time of a step [ms]"), "", 2) as chart:
        places = range(len(rows))
        left, right = chart.axes
        for k, (key, label) in enumerate((("converged", "converged"), ("divided", "divided"),
                                          ("clamped", "clamped"))):
            left.barh([p + 0.27 * (k - 1) for p in places], [row[key] for row in rows], 0.27,
                      label=label)
        left.set_yticks(list(places))
        left.set_yticklabels([row["scene"] for row in rows], fontsize=7)
        left.set_ylim(len(rows) - 0.4, -0.6)
        left.legend(fontsize="small", loc="lower left", bbox_to_anchor=(0, 1), ncol=3)
        chart.legend = {"loc": "lower left", "bbox_to_anchor": (0, 1)}
        right.barh(list(places), [row["ms"] for row in rows], 0.6, color="gray", label="mean")
        right.set_xscale("log")
        chart.figure.set_figheight(0.3 * len(rows) + 1.5)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command")
    parser.add_argument("folder")
    parser.add_argument("--steps", type=int, default=40)
    arguments = parser.parse_args()
    os.makedirs(arguments.folder, exist_ok=True)
    rows = []
    for group, name, scene in cases():
        most = 24 if group == "size" else arguments.steps
        row = run(arguments.command, name, scene, min(arguments.steps, most))
        rows.append(row)
        print(f"{name:20} converged {row['converged']:5.0%}  divided {row['divided']:5.0%} "
              f"(parts {row['parts']:2})  clamped {row['clamped']:5.0%}  passes {row['passes']:5.1f}  "
              f"contacts {row['contacts']:6}  least distance {row['distance']:6.3f} h  "
              f"inverted {row['inverted']:2}  {row['ms']:8.2f} ms", flush=True)
    with open(os.path.join(arguments.folder, "stress.csv"), "w", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, arguments.folder, arguments.steps)


if __name__ == "__main__":
    main()
