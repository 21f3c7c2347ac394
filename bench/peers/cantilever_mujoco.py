"""The cantilever in MuJoCo: a three-dimensional flex, six linear tetrahedra per cell.

MuJoCo gives each vertex the same mass; here each gets its share of the volume.
"""

import sys
import time

import mujoco
import numpy

import cantilever as c

SCENE = """<mujoco><option timestep="{step}" gravity="0 0 {gravity}" integrator="discrete">
<flag contact="disable"/></option><worldbody>
<flexcomp name="beam" type="grid" dim="3" count="{nx} {n} {n}" spacing="{h} {h} {h}" mass="10"
 radius="0.001" pos="0.5 0 0"><contact selfcollide="none"/>
<elasticity young="{young}" poisson="{nu}"/><pin gridrange="0 0 0 0 {cells} {cells}"/></flexcomp>
</worldbody></mujoco>"""


def run(nu, cells):
    h = c.WIDTH / cells
    step = 0.005
    model = mujoco.MjModel.from_xml_string(SCENE.format(
        step=step, gravity=-c.GRAVITY, nx=10 * cells + 1, n=cells + 1, h=h, young=c.YOUNG, nu=nu,
        cells=cells))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    points = data.flexvert_xpos.copy()
    low, high = points.min(axis=0), points.max(axis=0)
    on_side = (abs(points - low) < h / 4) | (abs(points - high) < h / 4)
    for body, halvings in zip(model.flex_vertbodyid, on_side.sum(axis=1)):
        if model.body_dofnum[body] > 0:
            model.body_mass[body] = c.DENSITY * h**3 / 2.0**halvings
    mujoco.mj_setConst(model, data)
    model.dof_damping[:] = c.DAMPING * model.body_mass[model.dof_bodyid]
    mujoco.mj_resetData(model, data)
    tip = points[:, 0] > high[0] - h / 4
    times, tips, start = [], [], time.perf_counter()
    for n in range(round(c.DURATION / step)):
        mujoco.mj_step(model, data)
        if n % 4 == 0:
            times.append(data.time)
            tips.append(numpy.mean(points[tip, 2] - data.flexvert_xpos[tip, 2]))
    elapsed = 1e3 * (time.perf_counter() - start) / round(c.DURATION / step)
    c.report(f"mujoco {mujoco.__version__}", nu, cells, step, elapsed, times, tips)


for argument in sys.argv[1:] or ["1", "2", "4"]:
    for poisson in (0.0, 0.3):
        run(poisson, int(argument))
