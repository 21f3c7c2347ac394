#!/usr/bin/env python3
"""Presses every key and drags with every button in a real window: what changes is what it says.

    check_keys.py COMMAND    exit status 77 where Xvfb or xdotool is missing

Pictures are those of the key F12. What a key causes in the thread of the simulation comes some
pictures later, so they are taken until it is seen.
"""
import math
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from check_screens import changed_pixels, cross, dot, minus, unit, write_tissue
from check_window import SECONDS, Display, fail, orange, pixels_of, view

SIZE = (240, 240)
TEXT = 95  # rows of the window with text
EYE, TARGET, ANGLE = (0, -1.6, 0.2), (0, 0, 0.2), 0.5  # of the camera; the angle is the default
FACE, TOP = -0.1, 0.2  # of the block: y of the side that is seen, z
TISSUE, TISSUE_RADIUS = (0.25, 0, 0), 0.06
BALL, FINGER, FINGER_RADIUS = (-0.25, 0, 0.2), (-0.25, 0, 0), 0.04

SCENE = """{"tetwarp_scene": 1, "time_step": 0.01, "duration": 1, "bodies": [
  {"name": "block", "kind": "fem", "shape": {"type": "box", "half": [0.1, 0.1, 0.2]},
   "lattice": {"cells": [2, 2, 3]}, "material": {"E": 2e5, "nu": 0.3, "density": 1000},
   "fixed": {"half_space": [0, 0, -1, 0.19]}},
  {"name": "weight", "kind": "rigid", "shape": {"type": "ellipsoid", "radii": [0.05, 0.05, 0.05]},
   "density": 4000, "pose": {"position": [0, 0, 0.2503]}}, TISSUE]}
"""


def ray_of(x, y):
    """Direction from the eye through the middle of a pixel, counted from the upper left."""
    ahead = unit(minus(TARGET, EYE))
    right = unit(cross(ahead, (0, 0, 1)))
    up = cross(right, ahead)
    scale = 2 * math.tan(ANGLE / 2) / SIZE[1]
    across, above = (x + 0.5 - SIZE[0] / 2) * scale, (SIZE[1] / 2 - y - 0.5) * scale
    return tuple(a + across * r + above * u for a, r, u in zip(ahead, right, up))


def pixel_of(x):
    """The pixel that shows a point."""
    ahead = unit(minus(TARGET, EYE))
    right = unit(cross(ahead, (0, 0, 1)))
    way, scale = minus(x, EYE), 2 * math.tan(ANGLE / 2) / SIZE[1]
    depth = dot(way, ahead)
    return (int(SIZE[0] / 2 + dot(way, right) / depth / scale),
            int(SIZE[1] / 2 - dot(way, cross(right, ahead)) / depth / scale))


class Window:
    """A view of the scene at the upper left of a display, until Escape."""

    def __init__(self, command, words, environment, folder):
        self.environment, self.folder, self.count = environment, folder, 0
        camera = ",".join(str(x) for x in EYE + TARGET)
        self.process = subprocess.Popen(
            [command, "view", "scene.json", "--size", f"{SIZE[0]},{SIZE[1]}", "--camera", camera, *words],
            env=environment, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.do("search --sync --onlyvisible --name tetwarp:.scene.json windowmove %1 0 0 "
                "windowfocus --sync %1")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()

    def do(self, steps):
        subprocess.run(["xdotool", *steps.split()], env=self.environment, timeout=SECONDS, check=True,
                       stdout=subprocess.DEVNULL)

    def picture(self, steps=""):
        """After some steps. @returns rows of pixels"""
        path = self.folder / f"view_{self.count:04}.png"
        self.do(f"{steps} key F12")
        end = time.monotonic() + SECONDS
        while not path.exists():
            if time.monotonic() > end or self.process.poll() is not None:
                fail(f"no {path.name}: status {self.process.poll()}")
            time.sleep(0.01)
        self.count += 1
        return pixels_of(path)[1]

    def until(self, what, holds, steps=""):
        """The first picture, each after some steps, of which something holds."""
        end = time.monotonic() + SECONDS
        while not holds(rows := self.picture(steps)):
            if time.monotonic() > end:
                fail(f"{what}: not seen")
        return rows

    def close(self):
        self.do("keydown Escape")
        _, problems = self.process.communicate(timeout=SECONDS)
        problems = [line for line in problems.splitlines() if not line.startswith("vrpn")]
        self.do("keyup Escape")
        if self.process.returncode != 0 or problems:
            fail(f"status {self.process.returncode}: {problems}")


def below(rows):
    return rows[TEXT:]


def differ(first, second):
    return changed_pixels(below(first), below(second))


def expect(what, changed, least=1, most=SIZE[0] * SIZE[1]):
    if not least <= changed <= most:
        fail(f"{what}: {changed} pixels have changed, expected {least} to {most}")


def warm(rows):
    return sum(orange(pixel) for row in below(rows) for pixel in row)


def check_camera(window, first):
    """Every key moves the camera; r brings the first picture back, to the last pixel."""
    for name in ("Left", "shift+Up", "plus", "KP_End", "KP_Home"):
        expect(name, differ(window.picture(f"key {name}"), first), 200)
        expect(f"r after {name}", differ(window.picture("key r"), first), 0, 0)
    # From posterior, where this camera is.
    expect("KP_Insert", differ(window.picture("key shift+KP_End key Left key KP_Insert"), first), 0, 0)
    window.do("key r mousemove 15 225 mousedown 1 mousemove 45 185 mouseup 1")  # beside the bodies
    expect("left beside the bodies", differ(window.picture(), first), 200)
    expect("r after it", differ(window.picture("key r"), first), 0, 0)
    x, y = pixel_of((0, FACE, 0.1))
    window.do(f"key g mousemove {x} {y} mousedown 1 mousemove {x + 30} {y} mouseup 1 key g")
    expect("left on the block after g", differ(window.picture(), first), 200)
    expect("r after it", differ(window.picture("key r"), first), 0, 0)


def check_looks(window, first):
    """Keys that change what is shown, and back."""
    expect("h: help", differ(window.picture("key h"), first), 300)
    expect("o: curve", differ(window.picture("key h key o"), first), 2000)
    cut = window.picture("key o key x")
    if not warm(first) > warm(cut) or differ(cut, first) < 300:
        fail(f"x: {warm(first)}, then {warm(cut)} pixels of the block")
    expect("c: contacts in the block", differ(window.picture("key c"), cut), 10, 500)
    deeper = window.picture("key c key Next key Next key Next")
    expect("Next: a deeper cut", differ(deeper, cut), 20)
    expect("Prior: back", differ(window.picture("key Prior key Prior key Prior"), cut), 0, 3)
    expect("x: no cut", differ(window.picture("key x"), first), 0, 0)
    window.do("key k")
    window.until("k: stress", lambda rows: differ(rows, first) > 500)
    window.do("key k key k key k")
    window.until("k: no colors", lambda rows: differ(rows, first) == 0)
    above = [changed_pixels(rows[:TEXT], first[:TEXT])
             for rows in (window.picture("mousemove %d %d key i" % pixel_of((0, FACE, 0.1))),
                          window.picture("mousemove 5 235 key i"))]
    if above[0] < 100 or above[1] < 50:
        fail(f"i: {above} pixels of text")


def check_volume(window, first):
    """Slices, which move and are shown alone, surfaces, and the window of the volume."""
    x, y = pixel_of(TISSUE)
    window.do(f"mousemove {x} {y} mousedown 3 mousemove {x - 180} 10 mouseup 3")
    expect("right: window", differ(window.picture(), first), 100)
    slices = window.picture("key v")
    expect("v: slices", differ(slices, first), 100)
    alone = [window.picture("key n") for _ in range(3)]
    for n, rows in enumerate(alone):
        expect(f"n: slice {n} alone", differ(rows, slices), 50)
        expect(f"n: slice {n} beside the next", differ(rows, alone[n - 1]), 50)
    expect("n: all slices", differ(window.picture("key n"), slices), 0, 0)
    moved = window.picture(f"mousemove {x} {y} keydown shift click 4 click 4 click 4 keyup shift")
    expect("shift and wheel: a slice", differ(moved, slices), 10, 3000)
    window.do(f"mousemove {x} {y} keydown shift click 5 click 5 click 5 keyup shift")
    expect("shift and wheel back", differ(window.picture(), slices), 0, 0)
    window.do("key v")
    window.until("v: surfaces", lambda rows: differ(rows, slices) > 100)
    window.do("key v")


def check_full_screen(window, first):
    """As large as the display, and back; there is no window manager."""
    full = window.picture("key F11")
    if (len(full[0]), len(full)) != (640, 480):
        fail(f"F11: {len(full[0])} x {len(full)} pixels")
    back = window.picture("key F11")
    if (len(back[0]), len(back)) != SIZE or differ(back, first) > 0:
        fail(f"F11 again: {len(back[0])} x {len(back)} pixels")


def check_steps(window, folder):
    """Pause, single steps, the start again, and a film."""
    first_line = window.picture()[:16]  # with the number of the step
    window.do("key BackSpace")
    start = window.until("BackSpace", lambda rows: rows[:16] != first_line)
    window.do("key space")
    window.until("space: moves", lambda rows: differ(rows, start) > 100)
    window.picture("key space key m key period key period key m")
    if (folder / "view_0000.gif").read_bytes()[:6] != b"GIF89a":
        fail("m: no film")
    window.do("key BackSpace")
    window.until("BackSpace: the start", lambda rows: differ(rows, start) == 0)


def check_tools(window):
    """A pull that Escape ends though the button is held, the ball, and the finger."""
    x, y = pixel_of((0, FACE, 0.1))
    window.do(f"mousemove {x} {y} mousedown 1 mousemove {x + 20} {y} key period key Escape "
              f"mousemove {x + 60} {y} key period mouseup 1")
    for center, radius in ((BALL, FINGER_RADIUS), (FINGER, FINGER_RADIUS)):
        x, y = pixel_of(minus(center, (0, radius, 0)))
        window.do(f"mousemove {x} {y} mousedown 1 mousemove {x - 10} {y} key period mouseup 1 key period")
    return pixel_of((0, FACE, 0.1))


def check_record(text, pixel):
    """What was done is in the record, and the block was taken where the middle of the pixel meets it."""
    lines = [line.split() for line in text.splitlines()[3:]]
    kinds = [words[1] for words in lines]
    if [kinds.count(kind) for kind in ("grab", "release", "restart")] != [1, 1, 2]:
        fail(f"record: not one pull and two restarts in\n{text}")
    pull = kinds[kinds.index("grab"):kinds.index("release")]
    if set(pull[1:]) - {"move"} or "move" in kinds[kinds.index("release"):]:
        fail(f"record: the pull does not end at Escape in\n{text}")
    carried = {words[2] for words in lines if words[1] == "carry"}
    if carried != {"ball", "finger_outside"}:
        fail(f"record: {carried} were carried")
    if not int(lines[-1][0]) > 8:
        fail(f"record: {lines[-1][0]} steps")
    grab = lines[kinds.index("grab")]
    place, ray = [float(x) for x in grab[3:6]], ray_of(*pixel)
    share = (FACE - EYE[1]) / ray[1]
    met = [e + share * r for e, r in zip(EYE, ray)]
    print(f"taken at {place}, {1e6 * math.dist(place, met):.1f} um from the ray of the pixel")
    if grab[2] != "block" or math.dist(place, met) > 1e-4:
        fail(f"record: taken at {place}, expected {met}")


def main():
    command = str(Path(sys.argv[1]).resolve())
    missing = [tool for tool in ("Xvfb", "xdotool") if not shutil.which(tool)]
    if missing:
        print(f"skipped: {' and '.join(missing)} not found; apt install xvfb xdotool")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="tetwarp-keys-") as name:
        folder = Path(name)
        tissue = write_tissue(folder, TISSUE, TISSUE_RADIUS)
        fixed = '{"fixed": {"half_space": [0, 0, -1, 0.05]},' + tissue.lstrip()[1:]
        (folder / "scene.json").write_text(SCENE.replace("TISSUE", fixed), encoding="ascii")
        inner = (FINGER[0], FINGER[1], FINGER[2] - 0.12)
        words = ["--paused", "--record", "input.txt", "--ball",
                 ",".join(str(x) for x in (*BALL, FINGER_RADIUS)), "--fingers",
                 ",".join(str(x) for x in (*FINGER, *inner, FINGER_RADIUS))]
        with Display() as environment, Window(command, words, environment, folder) as window:
            window.do("mousemove 5 235")
            before = window.picture()
            window.do(5 * "key period ")
            window.until("period: steps", lambda rows: differ(rows, before) > 5)
            first = window.picture()
            check_camera(window, first)
            check_looks(window, first)
            check_full_screen(window, first)
            check_volume(window, first)
            check_steps(window, folder)
            pixel = check_tools(window)
            window.close()
            # Without the ball and the fingers it is another scene.
            for option, file, problem in (("--record", "tissue.nii", "is also an input"),
                                          ("--replay", "input.txt", "was recorded with another scene")):
                refused = view(command, ["scene.json", option, file], environment, folder)
                if refused.returncode != 1 or f"{file}: {problem}" not in refused.stderr:
                    fail(f"{option} {file}: status {refused.returncode}, {refused.stderr!r}")
        check_record((folder / "input.txt").read_text(encoding="ascii"), pixel)


if __name__ == "__main__":
    main()
