"""Runs the six examples and draws what they compute, by matplotlib.

    python pictures.py FOLDER [EXAMPLE ...]

Writes FOLDER/python_warp_head.png and so on, of all examples or of those that are named.
"""

import os
import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np

import compare_solvers
import move_points
import register_nodes
import simulate_warp
import tetwarp
import warp_head
import warp_steps

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402, behind the choice of what draws


def panels(count, width, height, **options):
    """A figure of 100 dots per inch with panels in a row, each of width and height in inches."""
    figure, places = pyplot.subplots(
        1, count, figsize=(width * count, height), dpi=100, squeeze=False, layout="constrained",
        **options)
    return figure, list(places[0])


def show_slice(place, title, samples, **options):
    """Draws a slice [row][column], the first row below, as y and z grow upwards."""
    place.set_title(title, fontsize=9)
    place.axis("off")
    return place.imshow(samples, origin="lower", **{"cmap": "gray", **options})


def draw_warp_head(head, result, volume):
    """A slice of the image, of the bent image, and how its tissue grows and shrinks."""
    middle = head.shape[1] // 2
    figure, (before, after, change) = panels(3, 2.8, 2.5)
    options = dict(aspect=head.grid.spacing[2] / head.grid.spacing[0])
    limits = dict(vmin=0, vmax=head.array.max())
    show_slice(before, "image", head.array[:, middle], **limits, **options)
    show_slice(after, "bent", result.volume[:, middle], **limits, **options)
    local = np.where(volume.mask, volume.values, np.nan)[:, middle]
    colors = show_slice(
        change, "local volume", local, cmap="coolwarm", vmin=0.5, vmax=1.5, **options)
    figure.colorbar(colors, ax=change, shrink=0.8)
    return figure


def draw_warp_steps(head, images):
    """A slice across the axis of the twist, at rest and at each time."""
    figure, places = panels(1 + len(images), 1.9, 1.6)
    options = dict(vmin=0, vmax=head.array.max(),
                   aspect=head.grid.spacing[1] / head.grid.spacing[0])
    for place, (title, samples) in zip(places, {"at rest": head.array, **images}.items()):
        show_slice(place, title, samples[len(samples) // 8], **options)
    return figure


def draw_move_points(triangles, before, after):
    """The surface and the landmarks; `before` and `after` are points and landmarks."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    figure, places = panels(2, 3.2, 3.0, subplot_kw={"projection": "3d"})
    ends = np.concatenate([before[0], after[0][np.isfinite(after[0]).all(axis=1)]])
    low, high = ends.min(axis=0), ends.max(axis=0)
    for place, title, (points, landmarks) in zip(places, ("at rest", "bent"), (before, after)):
        faces = points[triangles]
        faces = faces[np.isfinite(faces).all(axis=(1, 2))]
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        light = np.abs(normals @ (0.3, -0.8, 0.5)) / (np.linalg.norm(normals, axis=1) + 1e-30)
        gray = np.stack([0.4 + 0.5 * light] * 3 + [np.full(len(light), 0.35)], axis=1)
        place.add_collection3d(Poly3DCollection(faces, facecolors=gray))
        place.scatter(*landmarks.T, color="tab:red", s=14, depthshade=False)
        place.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
        place.set_box_aspect(high - low)
        place.set_title(title, fontsize=9)
        place.view_init(18, -70)
        place.axis("off")
    return figure


def draw_compare_solvers(problem):
    """The residual of each method when it is stopped after so many sweeps."""
    figure, (place,) = panels(1, 5.0, 3.2)
    for method in compare_solvers.METHODS:
        ends = []
        for limit in np.unique(np.geomspace(1, 2000, 40).astype(int)):
            solution = tetwarp.solve_contacts(
                problem, method=method, tolerance=1e-12, max_sweeps=int(limit))
            ends.append((solution.report["sweeps"], max(solution.report["residual"], 1e-16)))
        style = dict(linewidth=5, alpha=0.3) if method == "auto" else dict(linewidth=1)
        place.loglog(*zip(*ends), ".-", label=method, markersize=3, **style)
    place.set(xlabel="sweeps", ylabel="residual eta", ylim=(1e-17, 2))
    place.legend(fontsize=8)
    return figure


def draw_simulate_warp(results):
    """Slices of the images where the orange is at each time, and the slope."""
    figure, (place,) = panels(1, 7.0, 2.2)
    ends = []
    for time, result in results.items():
        depth, rows, columns = result.volume.shape
        left, _, low = result.grid.origin
        right, high = np.array((left, low)) + simulate_warp.SPACING * np.array((columns, depth))
        covered = np.where(result.volume > 0, result.volume, np.nan)[:, rows // 2]
        show_slice(place, "", covered, cmap="inferno", extent=(left, right, low, high))
        place.text((left + right) / 2, high, f"{time:.2f} s", fontsize=7, ha="center")
        ends.append((left, right, low, high))
    left, right = min(end[0] for end in ends), max(end[1] for end in ends)
    x = np.array((left - 0.02, right + 0.02))
    place.plot(x, 0.2 * (0.05 - x), color="black", linewidth=1)
    place.set(xlim=x, ylim=(min(end[2] for end in ends) - 0.01, max(end[3] for end in ends) + 0.03))
    return figure


def draw_register_nodes(before, after, found, misfits):
    """Slices of the images and of their difference before and after, and the misfit."""
    middle = len(before) // 2
    figure, places = panels(5, 1.9, 2.0)
    titles = ("image before", "image after", "difference at start", "difference at end")
    for place, title, samples in zip(places, titles, (before, after, before - after, found - after)):
        limits = dict(vmin=0, vmax=1) if title.startswith("image") else dict(
            cmap="coolwarm", vmin=-0.3, vmax=0.3)
        show_slice(place, title, samples[middle], **limits)
    places[4].semilogy(misfits, linewidth=1)
    places[4].set_title("misfit by iteration", fontsize=9)
    places[4].tick_params(labelsize=7)
    return figure


PICTURES = {
    "warp_head": lambda: draw_warp_head(*warp_head.main()),
    "warp_steps": lambda: draw_warp_steps(*warp_steps.main()),
    "move_points": lambda: draw_move_points(*move_points.main()),
    "compare_solvers": lambda: draw_compare_solvers(*compare_solvers.main()),
    "simulate_warp": lambda: draw_simulate_warp(simulate_warp.main()),
    "register_nodes": lambda: draw_register_nodes(*register_nodes.main()),
}


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1]).resolve()
    names = sys.argv[2:] or list(PICTURES)
    del sys.argv[1:]  # the examples make their inputs
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        for name in names:
            PICTURES[name]().savefig(folder / f"python_{name}.png")
        os.chdir(folder)


if __name__ == "__main__":
    main()
