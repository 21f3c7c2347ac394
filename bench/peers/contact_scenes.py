"""The scenes that the contact_scenes_*.py programs step, and how their results are judged.

thrown  a cube of 0.1 m and 1 kg, thrown flat along a plane at 6 m/s with friction 0.5
stack   six cubes of 0.1 m on a plane at rest, masses 3^n kg from the lowest upward, friction 0.5
drape   a sheet of 1 m and 0.3 kg/m^2 in 20 x 20 cells that falls on a fixed sphere of radius 0.3 m

All take steps of 5 ms. Bodies are judged where a program reports them after every step: of cubes by
their corners, of the sheet by its nodes. Nothing here is taken from one of the programs. Times are of the
processor, on one thread.
"""

import itertools
import math

import numpy

STEP, GRAVITY, FRICTION = 0.005, 9.81, 0.5
SIDE, SPEED = 0.1, 6.0
MASSES = [3.0**n for n in range(6)]
CELLS, AREAL_DENSITY, STRETCH, RADIUS = 20, 0.3, 400.0, 0.3
DURATION = {"thrown": 2.0, "stack": 2.0, "drape": 1.0}

# Of implicit and semi-implicit Euler steps: the velocity after a step moves the cube in it.
STOPPING_DISTANCE = SPEED**2 / (2 * FRICTION * GRAVITY) - SPEED * STEP / 2

CORNERS = SIDE / 2 * numpy.array(list(itertools.product((-1, 1), repeat=3)))


def cube_at(center, rotation=numpy.eye(3)):
    """Corners of a cube, in the order of CORNERS."""
    return numpy.asarray(center) + CORNERS @ numpy.asarray(rotation).T


def rotation_of(w, x, y, z):
    """Of a quaternion."""
    s = 2 / (w * w + x * x + y * y + z * z)
    return numpy.array([[1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
                        [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
                        [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)]])


def overlap(first, second):
    """How far one of two cubes has to be moved at least to part them, or 0; separating axes."""
    own, other = ([cube[k] - cube[0] for k in (1, 2, 4)] for cube in (first, second))
    axes = own + other + [numpy.cross(i, j) for i in own for j in other]
    least = math.inf
    for axis in axes:
        length = numpy.linalg.norm(axis)
        if length < 1e-9:
            continue
        x, y = first @ axis / length, second @ axis / length
        least = min(least, x.max() - y.min(), y.max() - x.min())
    return max(least, 0.0)


def depth_of_cubes(cubes):
    """Of the deepest overlap of cubes with the plane z = 0 or with each other, or 0."""
    pairs = itertools.combinations(cubes, 2)
    return max([0.0, *(-cube[:, 2].min() for cube in cubes), *(overlap(*pair) for pair in pairs)])


def distance_to_triangles(nodes, triangles):
    """From the origin to the nearest point of any triangle, exact up to rounding."""
    corners = nodes[triangles].transpose(1, 0, 2)
    edges = [(p, q - p) for p, q in zip(corners, numpy.roll(corners, -1, axis=0))]
    normal = numpy.cross(edges[0][1], edges[1][1])
    height = (corners[0] * normal).sum(axis=1) / (normal * normal).sum(axis=1)
    foot = height[:, None] * normal
    inside = numpy.all([(numpy.cross(way, foot - p) * normal).sum(axis=1) >= 0
                        for p, way in edges], axis=0)
    least = [numpy.linalg.norm(foot[inside], axis=1)]
    for p, way in edges:
        t = numpy.clip(-(p * way).sum(axis=1) / (way * way).sum(axis=1), 0, 1)
        least.append(numpy.linalg.norm(p + t[:, None] * way, axis=1))
    return numpy.concatenate(least).min()


def sheet():
    """Nodes, lines of constant x one after the other, and triangles of the sheet at the start."""
    n = CELLS + 1
    at = numpy.linspace(-0.5, 0.5, n)
    nodes = numpy.array([(x, y, RADIUS + 0.02) for x in at for y in at])
    triangles = []
    for i, j in itertools.product(range(CELLS), repeat=2):
        k = n * i + j
        triangles += [(k, k + n, k + n + 1), (k, k + n + 1, k + 1)]
    return nodes, numpy.array(triangles)


def report_thrown(peer, cubes, milliseconds):
    """@param cubes  corners after each step, the start first."""
    lift = max(cube[:, 2].min() for cube in cubes) - cubes[0][:, 2].min()
    error = (cubes[-1] - cubes[0]).mean(axis=0)[0] / STOPPING_DISTANCE - 1
    depth = max(depth_of_cubes([cube]) for cube in cubes)
    print(f"| {peer} | thrown | {1e3 * lift:.3g} | {100 * error:+.2g} | {1e3 * depth:.3g} |"
          f" {milliseconds:.3g} |", flush=True)


def report_stack(peer, frames, milliseconds):
    """@param frames  after each step, the start first: corners of all cubes."""
    moved = abs(numpy.subtract(frames[-1], frames[0])).max()
    depth = max(depth_of_cubes(cubes) for cubes in frames)
    print(f"| {peer} | stack | {1e3 * moved:.3g} | | {1e3 * depth:.3g} | {milliseconds:.3g} |",
          flush=True)


def report_drape(peer, frames, triangles, milliseconds):
    """@param frames  arrays of nodes."""
    depth = max(RADIUS - distance_to_triangles(nodes, triangles) for nodes in frames)
    print(f"| {peer} | drape | | | {1e3 * max(depth, 0):.3g} | {milliseconds:.3g} |", flush=True)


HEADER = ("| program | scene | lift, or motion of the stack [mm] | stopping distance, error [%] |"
          " deepest overlap [mm] | ms a step |\n|---|---|---|---|---|---|")
