"""The cubes of contact_scenes.py in Newton (NVIDIA Warp) on the processor: XPBD, float32. Its sheet
of cloth sank into the sphere by half of the radius with the settings that were tried.
"""

import time

import newton
import warp

import contact_scenes as c

ITERATIONS = 10


def new_builder():
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0, 0, -c.GRAVITY))
    builder.default_shape_cfg.mu = c.FRICTION
    builder.default_shape_cfg.restitution = 0.0
    builder.add_ground_plane()
    return builder


def add_cube(builder, mass, height):
    body = builder.add_body(xform=warp.transform((0.0, 0.0, height), warp.quat_identity()))
    config = newton.ModelBuilder.ShapeConfig(density=mass / c.SIDE**3, mu=c.FRICTION)
    builder.add_shape_box(body, hx=c.SIDE / 2, hy=c.SIDE / 2, hz=c.SIDE / 2, cfg=config)


def run(scene, builder, speed=0.0):
    """Corners of all cubes after each step, and milliseconds a step."""
    model = builder.finalize(device="cpu")
    solver = newton.solvers.SolverXPBD(model, iterations=ITERATIONS)
    before, after, control = model.state(), model.state(), model.control()
    frames, spent = [], 0.0
    steps = round(c.DURATION[scene] / c.STEP)
    for n in range(-2, steps):  # two steps that are not counted compile its kernels
        if n == 0:
            before = model.state()
            if speed:
                start = before.body_qd.numpy()
                start[0, 0] = speed
                before.body_qd.assign(start)
            frames = [cubes_of(before)]
        begin = time.process_time()
        before.clear_forces()
        solver.step(before, after, control, model.collide(before), c.STEP)
        spent += time.process_time() - begin if n >= 0 else 0.0
        before, after = after, before
        frames.append(cubes_of(before))
    return frames, 1e3 * spent / steps


def cubes_of(state):
    poses = state.body_q.numpy().astype(float)
    return [c.cube_at(own[:3], c.rotation_of(own[6], *own[3:6])) for own in poses]


warp.config.quiet = True
peer = f"Newton {newton.__version__}, XPBD"
builder = new_builder()
add_cube(builder, 1.0, c.SIDE / 2)
frames, milliseconds = run("thrown", builder, c.SPEED)
c.report_thrown(peer, [own for own, in frames], milliseconds)

builder = new_builder()
for n, mass in enumerate(c.MASSES):
    add_cube(builder, mass, c.SIDE * (n + 0.5))
c.report_stack(peer, *run("stack", builder))
