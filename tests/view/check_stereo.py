#!/usr/bin/env python3
"""Stereo of screens, and a head that a tracker moves, in real windows.

    check_stereo.py COMMAND    exit status 77 where Xvfb or xdotool is missing

Four processes show the same screen of a room, each in another stereo, from where the tracker says that
the head is; a fifth asks for what this display does not have.
"""
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from check_screens import (BALLS, CAMERA_EYE, CAMERA_TARGET, CORNERS, FOCUS, PIXELS,
                           check_blob, end, free_port, seen, start, wait_for_window, write_files)
from check_window import SECONDS, Display, fail, pixels_of

EYES = 0.9  # between them
HEAD = (-0.1, 1.4, 0.35)  # where the tracker takes it
KINDS = ("none", "left", "right", "anaglyph", "quad_buffer")


def write_room(folder):
    low, side, high = CORNERS["right"]
    screens = ",".join(
        f"""{{"name": "{kind}", "stereo": "{kind}", "host": "another", "lower_left": {list(low)},
             "lower_right": {list(side)}, "upper_right": {list(high)},
             "window": [{20 * n}, 0, {PIXELS}, {PIXELS}]}}""" for n, kind in enumerate(KINDS))
    (folder / "room.json").write_text(
        f"""{{"tetwarp_room": 1, "observer": [0.3, 1.2, 0.2], "focus": {FOCUS}, "wait": 5,
              "eye_separation": {EYES}, "screens": [{screens}]}}""", encoding="ascii")


def check_channels(rows, expected):
    """Red shows what the left eye sees, green and blue what the right one sees."""
    back = rows[0][0]
    for name, channels, place in (("red", (0,), expected[0]), ("cyan", (1, 2), expected[1])):
        found = [(x, y) for y, row in enumerate(rows) for x, pixel in enumerate(row)
                 if all(abs(pixel[c] - back[c]) > 40 for c in channels)]
        if len(found) < 20:
            fail(f"anaglyph, {name}: {len(found)} pixels")
        middle = [sum(axis) / len(found) + 0.5 for axis in zip(*found)]
        if max(abs(a - b) for a, b in zip(middle, place)) > 0.5:
            fail(f"anaglyph, {name}: at {middle}, expected {place}")


def check_pictures(folder):
    shown = {kind: pixels_of(folder / f"{kind}.png")[1] for kind in KINDS[:-1]}
    places = {}
    for name, shift in (("none", 0), ("left", -EYES / 2), ("right", EYES / 2)):
        x, y = seen("right", BALLS["green"][0], shift, HEAD)
        places[name] = (PIXELS * x, PIXELS * y)
        check_blob(shown[name], "green", places[name])
    check_channels(shown["anaglyph"], (places["left"], places["right"]))
    away = abs(places["left"][0] - places["right"][0])
    print(f"the eyes see the ball {away:.1f} pixels apart")


def check_stereo(command, environment, folder):
    address = f"tcp://127.0.0.1:{free_port()}"
    camera = ",".join(str(x) for x in CAMERA_EYE + CAMERA_TARGET)
    master = start(command, ["scene.json", "--screens", "room.json", "--address", address, "--paused",
                             "--size", "200,150", "--camera", camera], environment, folder)
    screens = []
    try:
        tracker = [command, "view", "--join", address, "--tracker"]
        good = f"0 1 0\n{HEAD[0]} {HEAD[1]} {HEAD[2]} 2 0 0 0\n"
        for text, status in (("1 2\n", 1), ("0 1 0 -\n", 1), (good, 0)):
            done = subprocess.run(tracker, input=text, cwd=folder, timeout=SECONDS, text=True,
                                  capture_output=True)
            if done.returncode != status or ("line 1" in done.stderr) != (status == 1):
                fail(f"tracker: status {done.returncode}, {done.stderr!r}")
        for kind in KINDS:
            words = ["--join", address, "--screen", kind, "--screenshot", f"{kind}.png"]
            screens.append(start(command, words, environment, folder))
            if kind != "quad_buffer":
                wait_for_window(f"tetwarp screen: {kind}$", environment)
        _, problem = screens.pop().communicate(timeout=SECONDS)
        if "side_by_side or anaglyph" not in problem or problem.count("\n") != 1:
            fail(f"quad buffers: {problem!r}")
        end(master, "master")
        for process in screens:
            end(process, "screen")
    finally:
        for process in (*screens, master):
            process.kill()
    check_pictures(folder)


def main():
    command = str(Path(sys.argv[1]).resolve())
    missing = [tool for tool in ("Xvfb", "xdotool") if not shutil.which(tool)]
    if missing:
        print(f"skipped: {' and '.join(missing)} not found; apt install xvfb xdotool")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="tetwarp-stereo-") as name:
        folder = Path(name)
        write_files(folder)
        write_room(folder)
        with Display() as environment:
            check_stereo(command, environment, folder)


if __name__ == "__main__":
    main()
