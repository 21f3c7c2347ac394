#!/usr/bin/env python3
"""A room of three screens in real windows: what they show is where a room's geometry says.

    check_screens.py COMMAND    exit status 77 where Xvfb or xdotool is missing

The master starts the screens left and front; the screen right, in stereo, joins by a key, is killed
and joins again.
"""
import itertools
import math
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

from check_window import SCENE, SECONDS, Display, fail, pixels_of, press

PIXELS = 240  # width and height of each screen
WINDOW = (380, 340)  # width and height of the master's window in the test of the curve
EYE, EYE_SEPARATION, FOCUS = (0.3, 1.2, 0.2), 0.3, 1.5
CORNERS = {  # lower left, lower right, upper right of a cube of 3 m
    "left": ((-1.5, 0, 1.5), (-1.5, 0, -1.5), (-1.5, 3, -1.5)),
    "front": ((-1.5, 0, -1.5), (1.5, 0, -1.5), (1.5, 3, -1.5)),
    "right": ((1.5, 0, -1.5), (1.5, 0, 1.5), (1.5, 3, 1.5))}
# The camera looks along y, with 0.1 m of the world for a meter of the room.
CAMERA_EYE, CAMERA_TARGET, METER = (0, 0, 0), (0, 0.15, 0), 0.1
BALLS = {"orange": ((-0.18, 0.17, 0.01), 0.05),  # across the edge of left and front
         "blue": ((0.02, 0.2, 0.03), 0.01),      # on front
         "green": ((0.3, 0.05, 0.02), 0.025)}    # on right


TISSUE, TISSUE_RADIUS = (-0.18, 0.17, -0.075), 0.03  # a volume across the edge of left and front


def world_of(x):
    """A point of the room: x is x, y is z, and back is minus y of the world."""
    dx, dy, dz = (METER * (a - b) for a, b in zip(x, EYE))
    return dx, -dz, dy


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    size = math.sqrt(dot(a, a))
    return tuple(x / size for x in a)


def seen(screen, x, shift=0, head=EYE):
    """Where a screen shows a point of the world to an eye that is `shift` to the right of the head: shares
    of its width from the left and of its height from the top. The ray to the point meets the screen
    there."""
    low, side, high = (world_of(c) for c in CORNERS[screen])
    eye = world_of((head[0] + shift, head[1], head[2]))
    across, up = minus(side, low), minus(high, side)
    normal = unit(cross(across, up))
    way = minus(x, eye)
    share = dot(minus(low, eye), normal) / dot(way, normal)
    place = minus(tuple(e + share * w for e, w in zip(eye, way)), low)
    return dot(place, across) / dot(across, across), 1 - dot(place, up) / dot(up, up)


def write_tissue(folder, center=TISSUE, radius=TISSUE_RADIUS):
    """A ball of tissue in air, whose rim is soft, as NIfTI: by itself a volume across the edge of left
    and front. @returns its body"""
    n, size, (x, y, z) = 24, 2.4 * radius, center
    spacing = size / n
    samples = bytearray()
    for k, j, i in itertools.product(range(n), repeat=3):
        away = math.dist((i + 0.5, j + 0.5, k + 0.5), (n / 2, n / 2, n / 2)) * spacing
        value = min(max((radius - away) / (3 * spacing) + 0.5, 0), 1)
        samples += struct.pack("<h", round(1000 * value))
    # NIfTI-1: sizes, int16, spacings, offset, slope, meters, rows of the matrix.
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, n, n, n, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 4, 16)
    struct.pack_into("<8f", header, 76, 1, spacing, spacing, spacing, 1, 1, 1, 1)
    struct.pack_into("<2f", header, 108, 352, 1)
    header[123] = 1
    struct.pack_into("<h", header, 254, 1)
    for row, middle in enumerate((x, y, z)):
        numbers = [spacing * (column == row) for column in range(3)]
        struct.pack_into("<4f", header, 280 + 16 * row, *numbers, middle - size / 2 + spacing / 2)
    header[344:348] = b"n+1\0"
    (folder / "tissue.nii").write_bytes(header + samples)
    return """{"name": "tissue", "kind": "fem", "volume": {"file": "tissue.nii", "threshold": 300},
               "lattice": {"cells": [2, 2, 2]}, "material": {"E": 1e4, "nu": 0.3, "density": 1000}}"""


def write_files(folder):
    bodies = ",".join(
        f"""{{"name": "{name}", "kind": "rigid", "shape": {{"type": "ellipsoid",
             "radii": [{radius}, {radius}, {radius}]}}, "density": 1000,
             "pose": {{"position": {list(center)}}}}}"""
        for name, (center, radius) in BALLS.items()) + "," + write_tissue(folder)
    (folder / "scene.json").write_text(
        f"""{{"tetwarp_scene": 1, "time_step": 0.01, "duration": 1, "gravity": [0, 0, 0],
              "bodies": [{bodies}]}}""", encoding="ascii")
    screens = ",".join(
        f"""{{"name": "{name}", "lower_left": {list(c[0])}, "lower_right": {list(c[1])},
             "upper_right": {list(c[2])}, "window": [{PIXELS * n}, 0, {PIXELS}, {PIXELS}]
             {', "host": "another", "stereo": "side_by_side"' if name == "right" else ""}}}"""
        for n, (name, c) in enumerate(CORNERS.items()))
    (folder / "room.json").write_text(
        f"""{{"tetwarp_room": 1, "observer": {list(EYE)}, "focus": {FOCUS}, "wait": 5,
              "eye_separation": {EYE_SEPARATION}, "screens": [{screens}]}}""", encoding="ascii")


def is_color(name, pixel):
    r, g, b = pixel
    return {"orange": r > 25 and r > 1.5 * g and g > 1.4 * b,
            "blue": b > 20 and b > 1.25 * g and b > 2 * r,
            "green": g > 17 and g > 1.2 * b and g > 1.6 * r}[name]


def check_blob(rows, name, expected, columns=(0, PIXELS)):
    """The middle of the pixels of a ball is where its center is seen, to half a pixel."""
    found = [(x, y) for y, row in enumerate(rows) for x in range(*columns) if is_color(name, row[x])]
    if len(found) < 20:
        fail(f"{name}: {len(found)} pixels")
    middle = [sum(axis) / len(found) + 0.5 for axis in zip(*found)]
    if max(abs(a - b) for a, b in zip(middle, expected)) > 0.5:
        fail(f"{name}: at {middle}, expected {expected}")


def check_pictures(folder):
    shown = {name: pixels_of(folder / f"room_{name}.png")[1] for name in CORNERS}
    x, y = seen("front", BALLS["blue"][0])
    check_blob(shown["front"], "blue", (PIXELS * x, PIXELS * y))
    for half, side in enumerate((-1, 1)):
        x, y = seen("right", BALLS["green"][0], side * EYE_SEPARATION / 2)
        width = PIXELS / 2
        check_blob(shown["right"], "green", (width * (half + x), PIXELS * y),
                   (int(half * width), int((half + 1) * width)))
    edges = [[row[column] for row in shown[name]] for name, column in (("left", -1), ("front", 0))]
    covered = [[is_color("orange", pixel) for pixel in edge] for edge in edges]
    both = [n for n in range(PIXELS) if covered[0][n] and covered[1][n]]
    if len(both) < 30 or sum(a != b for a, b in zip(*covered)) > 2:
        fail(f"edge: {sum(covered[0])} and {sum(covered[1])} pixels, {len(both)} in common")
    difference = sum(abs(a - b) for n in both for a, b in zip(edges[0][n], edges[1][n]))
    if difference / (3 * len(both)) > 4:
        fail(f"edge: the pictures differ by {difference / (3 * len(both)):.1f} of 255")
    check_volume_edge(shown, edges)


def mean_difference(first, second, rows):
    """Of the colors of two columns of pixels [of 255]."""
    away = [abs(a - b) for n in rows for a, b in zip(first[n], second[n])]
    return sum(away) / len(away)


def check_volume_edge(shown, edges):
    """The volume across the edge of left and front: pixels on both sides differ by not much more than
    neighbors within one picture."""
    low, high = (seen("front", tuple(a + b for a, b in zip(TISSUE, (0, 0, side * TISSUE_RADIUS))))[1]
                 for side in (0.6, -0.6))
    rows = range(math.ceil(PIXELS * low), int(PIXELS * high))
    air = edges[0][4]
    covered = [max(abs(a - b) for a, b in zip(edges[0][n], air)) for n in rows]
    if len(rows) < 15 or min(covered) < 20:
        fail(f"volume: {len(rows)} rows at the edge, which differ by {min(covered)} from air")
    inner = [[row[column] for row in shown[name]] for name, column in (("left", -2), ("front", 1))]
    across = mean_difference(*edges, rows)
    beside = [mean_difference(inner[n], edges[n], rows) for n in (0, 1)]
    print(f"volume at the edge: {len(rows)} rows, mean difference {across:.2f} of 255 across it, "
          f"{beside[0]:.2f} and {beside[1]:.2f} beside it")
    if across > 1.5 * max(beside) + 1:
        fail("volume: the pictures differ at the edge")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_for_window(name, environment):
    """A screen gets its name when it has shown something."""
    subprocess.run(["xdotool", "search", "--sync", "--onlyvisible", "--name", name],
                   env=environment, timeout=SECONDS, check=True, stdout=subprocess.DEVNULL)


def end(process, what):
    process.send_signal(signal.SIGTERM)
    status = process.wait(SECONDS)
    if status != 0:
        fail(f"{what}: status {status}: {process.stderr.read()}")


def start(command, words, environment, folder, **options):
    return subprocess.Popen([command, "view", *words], env=environment, cwd=folder,
                            stderr=subprocess.PIPE, text=True, **options)


def check_room(command, environment, folder):
    subprocess.run([command, "view", "--make-keys", "room"], cwd=folder, timeout=SECONDS, check=True)
    if (folder / "room.key").stat().st_mode & 0o77:
        fail("keys: others may read them")
    made = (folder / "room.key").read_bytes()
    again = subprocess.run([command, "view", "--make-keys", "room"], cwd=folder, timeout=SECONDS,
                           capture_output=True, text=True)
    if again.returncode == 0 or "room.key" not in again.stderr:
        fail(f"keys again: status {again.returncode}, {again.stderr!r}")
    if (folder / "room.key").read_bytes() != made:
        fail("keys: overwritten")
    address = f"tcp://127.0.0.1:{free_port()}"
    camera = ",".join(str(x) for x in CAMERA_EYE + CAMERA_TARGET)
    master = start(command, ["scene.json", "--screens", "room.json", "--address", address, "--key",
                             "room.key", "--paused", "--size", "200,150", "--camera", camera,
                             "--screenshot", "room.png"], environment, folder)
    join = ["--join", address, "--screen", "right", "--key", "room_screen.key", "--screenshot",
            "room_right.png"]
    late = []
    try:
        for n in range(2):
            late.append(start(command, join, environment, folder))
            wait_for_window("tetwarp screen: right", environment)
            if n == 0:
                late[0].kill()
                late[0].wait(SECONDS)
        wait_for_window("tetwarp screen: front", environment)
        wait_for_window("tetwarp screen: left", environment)
        end(late[1], "right")
        end(master, "master")
    finally:
        for process in (*late, master):
            process.kill()
    check_pictures(folder)


def curve_place(value, opacity):
    """Pixel of a point of the curve in the master's window, from the upper left."""
    width, height, margin = 240, 110, 12  # of the panel in the lower right corner
    return (round(WINDOW[0] - margin - width * (1 - value)),
            round(WINDOW[1] - 1 - margin - height * opacity))


def changed_pixels(first, second):
    return sum(max(abs(a - b) for a, b in zip(p, q)) > 20
               for one, other in zip(first, second) if one != other
               for p, q in zip(one, other) if p != q)


def check_curve(command, environment, folder):
    """The mouse takes a point of the curve of volumes to more opacity, then turns its hue: the point is
    where it was released, in the color across the circle, and the volume looks different in the
    master's window and on its screen. A click beside the points changes neither."""
    x, y, z = TISSUE
    (folder / "scene.json").write_text(
        f"""{{"tetwarp_scene": 1, "time_step": 0.01, "duration": 1, "gravity": [0, 0, 0],
              "camera": {{"eye": [{x}, {y - 0.3}, {z}], "target": [{x}, {y}, {z}]}},
              "bodies": [{write_tissue(folder)}]}}""", encoding="ascii")
    (folder / "room.json").write_text(
        f"""{{"tetwarp_room": 1, "wait": 5, "address": "tcp://127.0.0.1:{free_port()}", "screens": [
              {{"name": "front", "lower_left": [-0.3, -0.3, -1], "lower_right": [0.3, -0.3, -1],
                "upper_right": [0.3, 0.3, -1], "window": [{WINDOW[0] + 20}, 0, 120, 120]}}]}}""",
        encoding="ascii")
    value, opacity, raised = 0.5, 0.08, 0.9  # a point of the preset ct, of a warm color
    left, low = curve_place(value, opacity)
    high = curve_place(value, raised)[1]
    beside = curve_place(0.25, 0.7)
    shown = []
    for name, steps in (
            ("click", f"mousemove {beside[0]} {beside[1]} mousedown 1 mousemove {left} {high} mouseup 1"),
            ("drag", f"""mousemove {left} {low} mousedown 1 mousemove {left} {high} mouseup 1
                         mousedown 3 mousemove {left - 100} {high} mouseup 3""")):
        words = ["scene.json", "--screens", "room.json", "--paused", "--size",
                 f"{WINDOW[0]},{WINDOW[1]}", "--screenshot", f"{name}.png"]
        press(command, words, f"key o {steps}", environment, folder)
        shown.append([pixels_of(folder / f"{name}{end}.png")[1] for end in ("", "_front")])
    (clicked, clicked_front), (dragged, dragged_front) = shown
    before, after = clicked[low][left], dragged[high][left]
    if before[0] < 1.5 * before[2] or after[2] < 1.5 * after[0]:
        fail(f"curve: its point was {before} and is {after}")
    inner = slice(70, WINDOW[1] - 140)  # between the text and the panel
    changed = [changed_pixels(clicked[inner], dragged[inner]),
               changed_pixels(clicked_front, dragged_front)]
    if min(changed) < 200:
        fail(f"curve: {changed} pixels of the window and the screen have changed")


def check_stress(command, environment, folder):
    """A screen colors a block that stands on its foot by its stress, as the master's window does."""
    (folder / "block.json").write_text(SCENE, encoding="ascii")
    done = subprocess.run(
        [command, "view", "block.json", "--screens", "room.json", "--fast", "--steps", "30", "--size",
         "240,240", "--screenshot", "stress.png", "--colors", "stress"],
        env=environment, cwd=folder, timeout=SECONDS, capture_output=True, text=True)
    if done.returncode != 0:
        fail(f"stress: status {done.returncode}: {done.stderr}")
    pixels = [pixel for row in pixels_of(folder / "stress_front.png")[1] for pixel in row]
    blue = sum(b > 70 and b > 1.5 * r and b > 1.2 * g for r, g, b in pixels)
    others = sum(max(r, g) > 60 and max(r, g) > 1.1 * b for r, g, b in pixels)
    print(f"stress on a screen: {blue} pixels of low, {others} of higher stress")
    if blue < 200 or others < 200:
        fail("stress: the screen does not show it")


def check_refusals(command, environment, folder):
    """Wrong input is one line and no process stays."""
    for words, expected in (
            (["scene.json", "--screens", "nowhere.json"], "nowhere.json"),
            (["scene.json", "--screens", "room.json", "--address", "tcp://*:5611"], "--make-keys"),
            (["scene.json", "--join", "tcp://127.0.0.1:1", "--screen", "a"], "SCENE"),
            (["--join", "tcp://127.0.0.1:1"], "--screen"),
            (["--join", "nowhere", "--screen", "a"], "address 'nowhere'"),
            (["--join", "tcp://127.0.0.1:1", "--screen", "a", "--screens", "wall"], "--screens"),
            (["--make-keys", "new", "--join", "tcp://127.0.0.1:1", "--screen", "a"], "--make-keys"),
            (["--make-keys", "new", "--screens", "wall"], "--make-keys"),
            ([], "SCENE")):
        done = subprocess.run([command, "view", *words], env=environment, cwd=folder,
                              timeout=SECONDS, capture_output=True, text=True)
        if done.returncode == 0 or expected not in done.stderr:
            fail(f"{words}: status {done.returncode}, {done.stderr!r}")


def main():
    command = str(Path(sys.argv[1]).resolve())
    missing = [tool for tool in ("Xvfb", "xdotool") if not shutil.which(tool)]
    if missing:
        print(f"skipped: {' and '.join(missing)} not found; apt install xvfb xdotool")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="tetwarp-screens-") as name:
        folder = Path(name)
        write_files(folder)
        with Display() as environment:
            check_refusals(command, environment, folder)
            check_room(command, environment, folder)
            check_curve(command, environment, folder)
            check_stress(command, environment, folder)


if __name__ == "__main__":
    main()
