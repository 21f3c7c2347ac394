"""The cubes of contact_scenes.py in Drake: discrete steps by SAP and by TAMSI, hydroelastic contact.

Cubes are compliant, the plane is rigid. It has no cloth.
"""

import importlib.metadata
import time

import pydrake.all as drake

import contact_scenes as c

MODULUS = 1e8  # hydroelastic [Pa]; with 1e6 and 1e7 the stack falls


def properties(is_rigid):
    own = drake.ProximityProperties()
    drake.AddContactMaterial(None, None, drake.CoulombFriction(c.FRICTION, c.FRICTION), own)
    if is_rigid:
        drake.AddRigidHydroelasticProperties(own)
    else:
        drake.AddCompliantHydroelasticProperties(c.SIDE, MODULUS, own)
    return own


def run(scene, solver, masses, speed):
    """Corners of all cubes after each step, and milliseconds a step."""
    builder = drake.DiagramBuilder()
    plant, graph = drake.AddMultibodyPlantSceneGraph(builder, c.STEP)
    plant.set_discrete_contact_approximation(solver)
    plant.set_contact_model(drake.ContactModel.kHydroelasticWithFallback)
    plant.mutable_gravity_field().set_gravity_vector([0, 0, -c.GRAVITY])
    plant.RegisterCollisionGeometry(plant.world_body(), drake.RigidTransform(), drake.HalfSpace(),
                                    "plane", properties(True))
    shape = drake.Box(c.SIDE, c.SIDE, c.SIDE)
    bodies = []
    for n, mass in enumerate(masses):
        inertia = drake.SpatialInertia.SolidBoxWithMass(mass, c.SIDE, c.SIDE, c.SIDE)
        body = plant.AddRigidBody(f"cube{n}", inertia)
        plant.RegisterCollisionGeometry(body, drake.RigidTransform(), shape, f"cube{n}",
                                        properties(False))
        bodies.append(body)
    plant.Finalize()
    diagram = builder.Build()
    simulator = drake.Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    for n, body in enumerate(bodies):
        plant.SetFreeBodyPose(context, body, drake.RigidTransform([0, 0, c.SIDE * (n + 0.5)]))
    plant.SetFreeBodySpatialVelocity(context=context, body=bodies[0],
                                     V_JpJc=drake.SpatialVelocity([0, 0, 0], [speed, 0, 0]))
    simulator.Initialize()

    def state():
        poses = [plant.EvalBodyPoseInWorld(context, body) for body in bodies]
        return [c.cube_at(pose.translation(), pose.rotation().matrix()) for pose in poses]

    frames, spent = [state()], 0.0
    steps = round(c.DURATION[scene] / c.STEP)
    for n in range(steps):
        start = time.process_time()
        simulator.AdvanceTo((n + 1) * c.STEP)
        spent += time.process_time() - start
        frames.append(state())
    return frames, 1e3 * spent / steps


for solver in (drake.DiscreteContactApproximation.kSap, drake.DiscreteContactApproximation.kTamsi):
    peer = f"Drake {importlib.metadata.version('drake')}, {solver.name[1:].upper()}"
    cubes, milliseconds = run("thrown", solver, [1.0], c.SPEED)
    c.report_thrown(peer, [own for own, in cubes], milliseconds)
    c.report_stack(peer, *run("stack", solver, c.MASSES, 0.0))
