"""Finds the deformation between two images: gradient descent on the positions of a mesh's nodes.

    python register_nodes.py

An image and a mesh are deformed by a known motion; from the image before and the image after, the
motion is found again. Prints the misfit of the images, the error of the nodes and the seconds.
"""

import time

import numpy as np

import tetwarp

SHAPE = (24, 24, 24)
ITERATIONS = 80


def image(random):
    """Smooth random structures of about four voxels, between 0 and 1."""
    waves = np.fft.fftn(random.standard_normal(SHAPE))
    z, y, x = np.meshgrid(*(np.fft.fftfreq(n) for n in SHAPE), indexing="ij")
    smooth = np.fft.ifftn(waves * np.exp(-80 * (z**2 + y**2 + x**2))).real
    return (smooth - smooth.min()) / np.ptp(smooth)


def main():
    before = image(np.random.default_rng(1))
    grid = tetwarp.Grid(SHAPE)
    rest, cells = tetwarp.lattice_mesh(tetwarp.Volume(before, grid), cells=4)
    inner = np.all((rest > 1) & (rest < 22), axis=1)
    x, y, z = (rest / 24 * 2 * np.pi).T
    motion = 1.2 * np.stack([np.sin(y), np.sin(z + 1), np.cos(x)], axis=1) * inner[:, None]
    after = tetwarp.WarpOperator(grid, rest, cells, rest + motion, interpolator="cubic").forward(
        before)

    start = time.perf_counter()
    misfits = []
    nodes, mean, square = rest.copy(), np.zeros_like(rest), np.zeros_like(rest)
    for iteration in range(ITERATIONS):
        operator = tetwarp.WarpOperator(grid, rest, cells, nodes, interpolator="cubic")
        misfit = operator.forward(before) - after
        gradient = operator.node_gradient(before, misfit) * inner[:, None]
        mean = 0.8 * mean + 0.2 * gradient  # Adam: steps of about one size for all nodes
        square = 0.95 * square + 0.05 * gradient**2
        nodes = nodes - 0.2 * (1 - iteration / ITERATIONS) * mean / (np.sqrt(square) + 1e-9)
        misfits.append(np.sqrt(np.mean(misfit**2)))
        if iteration % 20 == 0:
            print(f"{iteration:3} misfit {misfits[-1]:.5f}")
    seconds = time.perf_counter() - start

    error = np.linalg.norm(nodes - rest - motion, axis=1)[inner]
    moved = np.linalg.norm(motion, axis=1)[inner]
    print(f"{inner.sum()} nodes, moved by {moved.mean():.2f} voxels on average, found with an error "
          f"of {error.mean():.4f}, at most {error.max():.4f}, in {seconds:.2f} s")
    found = tetwarp.WarpOperator(grid, rest, cells, nodes, interpolator="cubic").forward(before)
    return before, after, found, misfits


if __name__ == "__main__":
    main()
