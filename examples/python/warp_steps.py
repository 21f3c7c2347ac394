"""Warps an image by every step of a finite-element result.

    python warp_steps.py [IMAGE MESH]

Without arguments a phantom and a mesh that is twisted in four steps are written first, as head.nii.gz
and steps.vtkhdf. Writes warped_0.nii.gz and so on.
"""

import sys

import numpy as np

import tetwarp


def write_inputs(image, mesh_file):
    head = tetwarp.phantom(shape=(61, 80, 64))
    mesh = tetwarp.lattice_mesh(head, cells=8, threshold=0.1 * float(head.array.max()))
    steps = [tetwarp.deform(*mesh, kind="twist", amount=amount) for amount in (0.1, 0.2, 0.3, 0.4)]
    tetwarp.write(image, head)
    tetwarp.write(mesh_file, mesh, deformed=steps, times=[0.25, 0.5, 0.75, 1])


def main():
    image, mesh_file = sys.argv[1:3] if len(sys.argv) > 2 else ("head.nii.gz", "steps.vtkhdf")
    if len(sys.argv) < 3:
        write_inputs(image, mesh_file)
    head, result = tetwarp.read(image), tetwarp.MeshFile(mesh_file)
    before = float(np.sum(head.array, dtype=np.float64))
    # One Warper for all steps: the image and the mesh at rest are prepared once. Density keeps the
    # sum of the samples, as of a tracer or a dose.
    images = {}
    with tetwarp.Warper(head, *result.mesh, intensity="density", antialias=True) as warper:
        for number, deformed in enumerate(result):
            warped = warper(deformed)
            tetwarp.write(f"warped_{number}.nii.gz", warped)
            images[f"time {result.times[number]:g}"] = warped.volume
            after = float(np.sum(warped.volume, dtype=np.float64))
            print(f"time {result.times[number]:g}: {warped}, sum {after / before:.4f} of the image")
    return head, images


if __name__ == "__main__":
    main()
