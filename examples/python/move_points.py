"""Moves landmarks and a surface with a deformed mesh, and back.

    python move_points.py

A surface of a phantom is moved by a bent lattice, and written before and after as surface.vtkhdf and
bent.vtkhdf. Prints how far landmarks moved and by how much the way back misses them.
"""

import numpy as np

import tetwarp


def main():
    head = tetwarp.phantom(shape=(32, 40, 32))
    mesh = tetwarp.lattice_mesh(head, cells=8)
    bent = tetwarp.deform(*mesh, kind="bend", amount=0.4)

    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    landmarks = low + (high - low) * np.random.default_rng(1).uniform(0.1, 0.9, (20, 3))
    moved, owners = tetwarp.transform_points(landmarks, *mesh, bent, return_owners=True)
    back = tetwarp.transform_points(moved, *mesh, bent, inverse=True)
    way = np.linalg.norm(moved - landmarks, axis=1)
    error = np.linalg.norm(back - landmarks, axis=1)
    print(f"{np.sum(owners >= 0)} landmarks in cells moved by {way.mean():.3g} on average; "
          f"the way back misses them by {error.max():.2g} at most")

    surface = tetwarp.isosurface(head, 0.5 * float(head.array.max()))
    points = tetwarp.transform_points(surface.points, *mesh, bent)
    tetwarp.write("surface.vtkhdf", surface)
    tetwarp.write("bent.vtkhdf", tetwarp.Surface(points, surface.triangles))
    print(f"a surface of {len(points)} points moved, {np.isnan(points).any(axis=1).sum()} of them "
          "in no cell")
    return surface.triangles, (surface.points, landmarks), (points, moved)


if __name__ == "__main__":
    main()
