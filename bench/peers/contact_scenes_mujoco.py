"""The scenes of contact_scenes.py in MuJoCo: elliptic cones, Newton's method, the rest by default.

Contacts are given the stiffest time constant that its documentation allows, twice the step.
"""

import time

import mujoco

import contact_scenes as c

SCENE = """<mujoco><option timestep="{step}" gravity="0 0 -{gravity}" cone="elliptic"
 integrator="implicitfast"/>
<default><geom friction="{friction}" solref="{constant} 1"/></default>
<worldbody>{obstacle}{bodies}</worldbody></mujoco>"""
PLANE = '<geom type="plane" size="0 0 1"/>'
CUBE = ('<body pos="0 0 {height}"><freejoint/><geom type="box" size="{half} {half} {half}"'
        ' mass="{mass}"/></body>')
SPHERE = '<geom type="sphere" size="{radius}"/>'
SHEET = """<body name="frame" pos="0 0 {height}"><flexcomp name="sheet" type="grid" dim="2" count="{n} {n} 1"
 spacing="{h} {h} 1" mass="{mass}" radius="0.001"><contact selfcollide="none" solref="{constant} 1"/>
<edge equality="true" damping="0.002"/></flexcomp></body>"""


def run(scene, obstacle, bodies, state):
    """What `state` tells after each step, and milliseconds a step."""
    model = mujoco.MjModel.from_xml_string(SCENE.format(
        step=c.STEP, gravity=c.GRAVITY, friction=c.FRICTION, constant=2 * c.STEP,
        obstacle=obstacle, bodies=bodies))
    data = mujoco.MjData(model)
    if scene == "thrown":
        data.qvel[0] = c.SPEED
    mujoco.mj_forward(model, data)
    frames, spent = [state(model, data)], 0.0
    steps = round(c.DURATION[scene] / c.STEP)
    for _ in range(steps):
        start = time.process_time()
        mujoco.mj_step(model, data)
        spent += time.process_time() - start
        mujoco.mj_kinematics(model, data)
        mujoco.mj_flex(model, data)
        frames.append(state(model, data))
    return frames, 1e3 * spent / steps


def cubes(model, data):
    return [c.cube_at(data.xpos[body], data.xmat[body].reshape(3, 3))
            for body in range(1, model.nbody)]


peer = f"MuJoCo {mujoco.__version__}"
half = c.SIDE / 2
poses, milliseconds = run("thrown", PLANE, CUBE.format(height=half, half=half, mass=1), cubes)
c.report_thrown(peer, [own for own, in poses], milliseconds)
stack = "".join(CUBE.format(height=half + n * c.SIDE, half=half, mass=mass)
                for n, mass in enumerate(c.MASSES))
c.report_stack(peer, *run("stack", PLANE, stack, cubes))
sheet = SHEET.format(height=c.RADIUS + 0.02, n=c.CELLS + 1, h=1 / c.CELLS, mass=c.AREAL_DENSITY,
                     constant=2 * c.STEP)
_, triangles = c.sheet()
frames, milliseconds = run("drape", SPHERE.format(radius=c.RADIUS), sheet,
                           lambda model, data: data.flexvert_xpos.copy())
c.report_drape(peer, frames, triangles, milliseconds)
