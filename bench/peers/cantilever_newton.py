"""The cantilever in Newton (NVIDIA Warp) on the processor: vertex block descent, five linear
Neo-Hookean tetrahedra per cell, float32.

Each step is backward Euler, solved by a fixed number of descents; with too few the beam has not
converged. Newton gives each particle of a grid the same mass; here each gets its share of the
volume. It has no damping by mass: velocities are divided by 1 + damping dt after each step.
Usage: cantilever_newton.py [CELLS:DESCENTS ...]
"""

import sys
import time

import newton
import numpy
import warp

import cantilever as c

STEP = 0.005


def beam(nu, cells):
    h = c.WIDTH / cells
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0, 0, -c.GRAVITY))
    builder.add_soft_grid(
        pos=warp.vec3(0, 0, 0), rot=warp.quat_identity(), vel=warp.vec3(0, 0, 0),
        dim_x=10 * cells, dim_y=cells, dim_z=cells, cell_x=h, cell_y=h, cell_z=h,
        density=c.DENSITY, k_mu=c.YOUNG / (2 * (1 + nu)),
        k_lambda=c.YOUNG * nu / ((1 + nu) * (1 - 2 * nu)), k_damp=0.0, fix_left=True,
        particle_radius=1e-3)
    points = numpy.array([list(q) for q in builder.particle_q])
    low, high = points.min(axis=0), points.max(axis=0)
    sides = ((abs(points - low) < h / 4) | (abs(points - high) < h / 4)).sum(axis=1)
    for p, count in enumerate(sides):
        held = points[p, 0] < h / 4
        builder.particle_mass[p] = 0.0 if held else c.DENSITY * h**3 / 2.0**count
    builder.color()
    return builder.finalize(device="cpu")


def run(nu, cells, descents):
    model = beam(nu, cells)
    solver = newton.solvers.SolverVBD(model, iterations=descents)
    before, after, control = model.state(), model.state(), model.control()
    points = before.particle_q.numpy().copy()
    tip = points[:, 0] > points[:, 0].max() - 1e-6
    times, tips, elapsed = [], [], 0.0
    steps = round(c.DURATION / STEP)
    for n in range(-2, steps):
        if n == 0:
            before.particle_q.assign(points)
            before.particle_qd.zero_()
        start = time.perf_counter()
        solver.step(before, after, control, None, STEP)
        elapsed += time.perf_counter() - start if n >= 0 else 0.0
        after.particle_qd.assign(after.particle_qd.numpy() / (1 + c.DAMPING * STEP))
        before, after = after, before
        if n >= 0 and n % 4 == 0:
            times.append((n + 1) * STEP)
            tips.append(numpy.mean(points[tip, 2] - before.particle_q.numpy()[tip, 2]))
    c.report(f"newton {newton.__version__}, {descents} descents", nu, cells, STEP,
             1e3 * elapsed / steps, times, tips)


warp.config.quiet = True
for argument in sys.argv[1:] or ["1:20", "1:100", "2:20", "2:100", "4:20", "4:100"]:
    for poisson in (0.0, 0.3):
        run(poisson, *(int(number) for number in argument.split(":")))
