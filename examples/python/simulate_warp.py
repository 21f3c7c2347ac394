"""Drops an orange, which is an image, on a slope; its image follows every tenth step.

    python simulate_warp.py

Writes orange_1.nii.gz to orange_4.nii.gz, each on a grid around the place where the orange is then.
"""

import numpy as np

import tetwarp


SPACING = 0.003  # of voxels [m]


def make_scene():
    return {
        "tetwarp_scene": 1,
        "time_step": 0.01,
        "duration": 0.4,
        "bodies": [{
            "name": "orange",
            "kind": "fem",
            "volume": {"phantom": "orange", "dims": [32, 32, 32], "spacing": [SPACING] * 3},
            "lattice": {"cells": [4, 4, 4]},
            "material": {"E": 3e4, "nu": 0.3, "density": 900},
            "pose": {"position": [0, 0, 0.02]},
        }],
        "obstacles": [{"name": "slope", "plane": {"normal": [0.2, 0, 1], "point": [0.05, 0, 0]}}],
    }


def main():
    simulator = tetwarp.Simulator(make_scene())
    image = simulator.volume("orange")
    mesh = simulator.mesh("orange")
    results = {}
    for step in simulator.run():
        if step % 10:
            continue
        nodes = simulator.positions("orange")
        low, high = nodes.min(axis=0), nodes.max(axis=0)
        shape = np.ceil((high - low) / SPACING).astype(int)[::-1] + 1
        x, y, z = low
        around = tetwarp.Grid(tuple(shape), (SPACING, SPACING, SPACING), (x, y, z))
        result = tetwarp.warp(image, *mesh, nodes, reference=around)
        results[simulator.time] = result
        tetwarp.write(f"orange_{step // 10}.nii.gz", result)
        print(f"{simulator.time:.2f} s, {len(simulator.contacts())} contacts: {result}")
    return results


if __name__ == "__main__":
    main()
