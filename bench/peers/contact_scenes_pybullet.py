"""The cubes of contact_scenes.py in PyBullet with its defaults. A sheet of its soft bodies fell
through the fixed sphere with all settings that were tried.
"""

import importlib.metadata
import time

import numpy
import pybullet

import contact_scenes as c


def start():
    pybullet.resetSimulation()
    pybullet.setGravity(0, 0, -c.GRAVITY)
    pybullet.setTimeStep(c.STEP)


def add(shape, mass, center):
    body = pybullet.createMultiBody(mass, pybullet.createCollisionShape(*shape[0], **shape[1]),
                                    basePosition=center)
    # The friction of a pair is the product of both.
    pybullet.changeDynamics(body, -1, lateralFriction=c.FRICTION**0.5, linearDamping=0,
                            angularDamping=0)
    return body


def step(scene, state):
    """What `state` tells after each step, and milliseconds a step."""
    frames, spent = [state()], 0.0
    steps = round(c.DURATION[scene] / c.STEP)
    for _ in range(steps):
        begin = time.process_time()
        pybullet.stepSimulation()
        spent += time.process_time() - begin
        frames.append(state())
    return frames, 1e3 * spent / steps


def cube_of(body):
    center, turn = pybullet.getBasePositionAndOrientation(body)
    return c.cube_at(center, numpy.reshape(pybullet.getMatrixFromQuaternion(turn), (3, 3)))


PLANE = ((pybullet.GEOM_PLANE,), {})
CUBE = ((pybullet.GEOM_BOX,), {"halfExtents": [c.SIDE / 2] * 3})

pybullet.connect(pybullet.DIRECT)
peer = f"PyBullet {importlib.metadata.version('pybullet')}"
start()
add(PLANE, 0, [0, 0, 0])
cube = add(CUBE, 1, [0, 0, c.SIDE / 2])
pybullet.resetBaseVelocity(cube, [c.SPEED, 0, 0])
c.report_thrown(peer, *step("thrown", lambda: cube_of(cube)))

start()
add(PLANE, 0, [0, 0, 0])
cubes = [add(CUBE, mass, [0, 0, c.SIDE * (n + 0.5)]) for n, mass in enumerate(c.MASSES)]
c.report_stack(peer, *step("stack", lambda: [cube_of(body) for body in cubes]))
