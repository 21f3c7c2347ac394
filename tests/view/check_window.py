#!/usr/bin/env python3
"""Watches and pulls scenes in a real window: Xvfb with events of xdotool.

    check_window.py COMMAND    exit status 77 where Xvfb or xdotool is missing
"""
import itertools
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

SECONDS = 100  # that one call of the command may take

SCENE = """{"tetwarp_scene": 1, "time_step": 0.01, "duration": 1,
  "bodies": [{"name": "block", "kind": "fem", "shape": {"type": "box", "half": [0.1, 0.1, 0.2]},
              "lattice": {"cells": [2, 2, 3]},
              "material": {"E": 2e4, "nu": 0.3, "density": 1000},
              "fixed": {"half_space": [0, 0, -1, 0.19]}}]}
"""


def fail(text):
    print(text)
    sys.exit(1)


def unfiltered(kind, line, before):
    """A row of a PNG of three bytes a pixel, from the bytes of its filter and the row before it."""
    if kind == 2:
        return bytearray((a + b) & 255 for a, b in zip(line, before))
    for channel in range(3) if kind else ():
        values, above = line[channel::3], before[channel::3]
        if kind == 1:
            values = itertools.accumulate(values, lambda a, b: (a + b) & 255)
        else:
            left = corner = 0
            for n, (value, up) in enumerate(zip(values, above)):
                if kind == 3:
                    near = (left + up) // 2
                else:
                    a, b, c = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
                    near = left if a <= b and a <= c else up if b <= c else corner
                values[n] = left = (value + near) & 255
                corner = up
        line[channel::3] = bytes(values)
    return line


def pixels_of(path):
    """Width, and rows of (red, green, blue), of a PNG without interlacing."""
    data, chunks, place = path.read_bytes(), {}, 8
    while place < len(data):
        size, kind = struct.unpack(">I4s", data[place:place + 8])
        chunks[kind] = chunks.get(kind, b"") + data[place + 8:place + 8 + size]
        place += size + 12
    width, height = struct.unpack(">II", chunks[b"IHDR"][:8])
    raw, stride, rows = zlib.decompress(chunks[b"IDAT"]), 3 * width, []
    line = bytearray(stride)
    for y in range(height):
        start = y * (stride + 1)
        line = unfiltered(raw[start], bytearray(raw[start + 1:start + 1 + stride]), line)
        rows.append(list(zip(line[::3], line[1::3], line[2::3])))
    return width, rows


def orange(pixel):
    """Whether it has the first body's color, in any light."""
    r, g, b = pixel
    return r > 60 and r > 1.5 * g and g > 1.4 * b


def orange_pixels(path):
    _, rows = pixels_of(path)
    return [(x, y) for y, row in enumerate(rows) for x, pixel in enumerate(row) if orange(pixel)]


def foot_of(pixels):
    """Those of the lowest row."""
    lowest = max(y for _, y in pixels)
    return [place for place in pixels if place[1] == lowest]


class Display:
    """A server without a screen, gone at the end of the with block."""

    def __enter__(self):
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(write), "-screen", "0", "640x480x24", "-noreset",
             "-nolisten", "tcp"],
            pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as numbers:
            number = numbers.readline().strip()
        if not number:
            fail("Xvfb did not start")
        return os.environ | {"DISPLAY": ":" + number}

    def __exit__(self, *_):
        self.server.terminate()
        self.server.wait()


def view(command, words, environment, folder):
    return subprocess.run([command, "view", *words], env=environment, cwd=folder, timeout=SECONDS,
                          capture_output=True, text=True)


def press(command, words, steps, environment, folder):
    """Views the scene at the upper left of the display while xdotool takes steps there, and ends by
    the key Escape, which does not come up, since its window is gone by then. @returns what it
    prints"""
    with subprocess.Popen([command, "view", *words], env=environment, cwd=folder,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as window:
        try:
            subprocess.run(
                f"""xdotool search --sync --onlyvisible --name tetwarp:.scene.json windowmove %1 0 0
                    windowfocus --sync %1 {steps} keydown Escape""".split(),
                env=environment, timeout=SECONDS, check=True, stdout=subprocess.DEVNULL)
            printed, problems = window.communicate(timeout=SECONDS)
            subprocess.run(["xdotool", "keyup", "Escape"], env=environment, timeout=SECONDS, check=True)
        finally:
            window.kill()
    if window.returncode != 0 or problems:
        fail(f"{' '.join(words)}: status {window.returncode}: {problems}")
    return printed


def check_without_display(command, folder):
    environment = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
    for shown in ({}, {"DISPLAY": ":987"}):
        done = view(command, ["scene.json"], environment | shown, folder)
        if done.returncode != 1 or done.stderr.count("\n") != 1 or "display" not in done.stderr:
            fail(f"without a display: status {done.returncode}, {done.stderr!r}")


def check_picture(command, environment, folder):
    done = view(command, ["scene.json", "--fast", "--steps", "3", "--size", "320,240",
                          "--screenshot", "block.png"], environment, folder)
    if done.returncode != 0:
        fail(f"picture: status {done.returncode}: {done.stderr}")
    body = orange_pixels(folder / "block.png")
    if len(body) < 2000:
        fail(f"picture: {len(body)} pixels show the body")
    return body


def check_pull(command, environment, folder, body):
    """A drag with single steps; its record gives the same bits."""
    x = sum(place[0] for place in body) // len(body)
    y = min(place[1] for place in body if place[0] == x) + 12
    words = ["scene.json", "--paused", "--size", "320,240", "--record", "input.txt",
             "--checkpoint", "first.bin"]
    steps = f"""mousemove {x} {y} mousedown 1 mousemove {x + 40} {y - 10} key period
        mousemove {x + 60} {y - 20} key period key period mouseup 1 key period key period"""
    press(command, words, steps, environment, folder)
    text = (folder / "input.txt").read_text(encoding="ascii")
    for word in (" grab block ", " move ", " release\n", "5 end\n"):
        if word not in text:
            fail(f"pull: no '{word.strip()}' in\n{text}")
    done = view(command, ["scene.json", "--replay", "input.txt", "--size", "320,240",
                          "--checkpoint", "second.bin"], environment, folder)
    if done.returncode != 0:
        fail(f"replay: status {done.returncode}: {done.stderr}")
    if (folder / "first.bin").read_bytes() != (folder / "second.bin").read_bytes():
        fail("replay: another state than the recorded one")


def check_right_button(command, environment, folder, body):
    """During a pull the right button does nothing: the pull goes on to where the pointer is, and the
    foot of the block, which is fixed, stays where it is in the picture, so that nothing has zoomed."""
    x = sum(place[0] for place in body) // len(body)
    y = min(place[1] for place in body if place[0] == x) + 12
    words = ["scene.json", "--paused", "--size", "320,240", "--record", "right.txt", "--screenshot",
             "right.png"]
    steps = f"""mousemove {x} {y} mousedown 1 mousemove {x + 30} {y} key period mousedown 3
        mousemove {x + 30} {y + 60} key period mouseup 3 mousemove {x + 40} {y} key period mouseup 1
        key period"""
    press(command, words, steps, environment, folder)
    text = (folder / "right.txt").read_text(encoding="ascii")
    lines = [line.split() for line in text.splitlines()]
    moves = [[float(number) for number in words[2:]] for words in lines if words[1:2] == ["move"]]
    counts = [sum(words[1:2] == [kind] for words in lines) for kind in ("grab", "release")]
    if counts != [1, 1] or len(moves) < 2:
        fail(f"right button: {counts} grabs and releases, {len(moves)} moves in\n{text}")
    across = max(abs(way) for way in moves[-1][:2])
    if across < 0.01 or abs(moves[-1][2]) > 0.2 * across:
        fail(f"right button: the pull ends at {moves[-1]}, not beside where it began")
    if foot_of(body) != foot_of(orange_pixels(folder / "right.png")):
        fail("right button: the foot of the block is elsewhere in the picture")


def check_colors(command, environment, folder):
    """The key k colors the block by its stress: it stands on its foot, so that the colors of
    both ends of the scale are there. It is still sinking, so that the scale ends at the stress of now,
    whichever states were shown."""
    words = ["scene.json", "--fast", "--steps", "10", "--size", "320,240", "--screenshot",
             "stress.png", "--colors", "stress"]
    done = view(command, words, environment, folder)
    if done.returncode != 0:
        fail(f"colors: status {done.returncode}: {done.stderr}")
    width, rows = pixels_of(folder / "stress.png")
    inner = [p for row in rows for p in row[:width * 4 // 5]]  # without the legend
    blue = sum(b > 70 and b > 1.5 * r and b > 1.2 * g for r, g, b in inner)
    warm = sum(r > 70 and r > 1.8 * b for r, g, b in inner)
    if blue < 200 or warm < 50:
        fail(f"colors: {blue} pixels of low stress, {warm} of high stress")


def check_device(command, environment, folder):
    """A simulated device pulls at what is in the middle of the window, and the run is filmed; its
    record gives the same bits, and a replay writes its pictures one by one."""
    (folder / "motion.txt").write_text("0.1 0 0 0 0 0.5 0 0\n0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n"
                                       "0.1 0.5 1 0 0 0 0 1\n0 0 0 0 0 0 0 0\n", encoding="ascii")
    words = ["scene.json", "--fast", "--steps", "20", "--size", "320,240", "--devices", "motion.txt",
             "--record", "device.txt", "--film", "device.gif", "--checkpoint", "first.bin"]
    done = view(command, words, environment, folder)
    if done.returncode != 0 or done.stderr:
        fail(f"device: status {done.returncode}: {done.stderr}")
    text = (folder / "device.txt").read_text(encoding="ascii")
    for word in (" grab block ", " move ", " release\n", "20 end\n"):
        if word not in text:
            fail(f"device: no '{word.strip()}' in\n{text}")
    if (folder / "device.gif").read_bytes()[:6] != b"GIF89a":
        fail("device: no film")
    done = view(command, ["scene.json", "--replay", "device.txt", "--size", "320,240", "--film",
                          "frames.png", "--checkpoint", "second.bin"], environment, folder)
    if done.returncode != 0:
        fail(f"device replay: status {done.returncode}: {done.stderr}")
    if (folder / "first.bin").read_bytes() != (folder / "second.bin").read_bytes():
        fail("device replay: another state than the recorded one")
    if len(orange_pixels(folder / "frames_0000.png")) < 2000:
        fail("film: its first picture does not show the body")
    missing = view(command, ["scene.json", "--devices", "nothing.txt"], environment, folder)
    if missing.returncode != 1 or "nothing.txt" not in missing.stderr:
        fail(f"missing device: status {missing.returncode}, {missing.stderr!r}")


def check_film_failure(command, environment, folder):
    """A film whose file cannot be written is an error at the end; the other results are written."""
    (folder / "full_0000.png").mkdir()
    done = view(command, ["scene.json", "--fast", "--steps", "3", "--size", "320,240", "--film",
                          "full.png", "--record", "full.txt", "--checkpoint", "full.bin"],
                environment, folder)
    if done.returncode != 1 or "full_0000.png" not in done.stderr:
        fail(f"film failure: status {done.returncode}, {done.stderr!r}")
    if not (folder / "full.txt").is_file() or not (folder / "full.bin").is_file():
        fail("film failure: record and checkpoint are missing")


def main():
    command = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory(prefix="tetwarp-window-") as name:
        folder = Path(name)
        (folder / "scene.json").write_text(SCENE, encoding="ascii")
        check_without_display(command, folder)
        missing = [tool for tool in ("Xvfb", "xdotool") if not shutil.which(tool)]
        if missing:
            print(f"skipped: {' and '.join(missing)} not found; apt install xvfb xdotool")
            sys.exit(77)
        with Display() as environment:
            body = check_picture(command, environment, folder)
            check_pull(command, environment, folder, body)
            check_right_button(command, environment, folder, body)
            check_device(command, environment, folder)
            check_film_failure(command, environment, folder)
            check_colors(command, environment, folder)


if __name__ == "__main__":
    main()
