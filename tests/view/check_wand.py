#!/usr/bin/env python3
"""A wand of a VRPN server pulls at a body in a real window, which goes on without the server; a head of it
sees a room.

    check_wand.py COMMAND SERVER    exit status 77 where Xvfb or xdotool is missing
"""
import math
import shutil
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

from check_keys import EYE, FACE, SCENE, SIZE, TARGET, TEXT, Window, differ
from check_screens import (BALLS, CAMERA_EYE, CAMERA_TARGET, PIXELS, changed_pixels, check_blob, end,
                           free_port, seen, start, wait_for_window, write_files, write_tissue)
from check_window import SECONDS, Display, fail, pixels_of

METER = math.dist(EYE, TARGET) / 0.6  # of the room in the world: without screens the window is at 0.6 m
LOW, ACROSS = -0.1, 0.02  # of the wand below the eyes, and its way to the right, in the room [m]


class Server:
    """One tracker, which ends with the block."""

    def __init__(self, program, port):
        self.process = subprocess.Popen([program, str(port)], stdin=subprocess.PIPE, text=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait(SECONDS)

    def say(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()


def rays(rows):
    return sum(b > 200 and r < 60 and g < 120 for row in rows[TEXT:] for r, g, b in row)


def third_line(rows):
    """The rows of the text that stands there while there is a force, no server, or a note, which the next
    key ends."""
    return rows[34:50]


def dark(rows):
    return sum(max(pixel) < 80 for row in rows for pixel in row)


def pull(window, server):
    """Takes the block, pulls it to the right, and lets go."""
    before = window.picture()
    server.say("button 0 1")
    window.until("the grab", lambda rows: dark(third_line(rows)) > 50, "key c key c")
    server.say(f"pose 0 {ACROSS} {LOW} 0 0 0 0 1")
    window.until("the pull", lambda rows: differ(rows, before) > 400, "key period")
    server.say("button 0 0")
    window.until("the release", lambda rows: dark(third_line(rows)) == 0, "key period")


def check_record(text):
    lines = [line.split() for line in text.splitlines()[3:]]
    kinds = [words[1] for words in lines]
    if kinds.count("grab") != 1 or kinds.count("release") != 1 or "move" not in kinds:
        fail(f"record: not one pull in\n{text}")
    grab = lines[kinds.index("grab")]
    place = [float(x) for x in grab[3:6]]
    expected = (0, FACE, EYE[2] + METER * LOW)
    way = [float(x) for x in lines[len(kinds) - 1 - kinds[::-1].index("move")][2:5]]
    if grab[2] != "block" or math.dist(place, expected) > 1e-6:
        fail(f"record: {grab[2]} taken at {place}, expected {expected}")
    if math.dist(way, (METER * ACROSS, 0, 0)) > 1e-6:
        fail(f"record: pulled by {way}")


def wait_for_line(process, text):
    """Ends the process where it does not say so in time."""
    late = threading.Timer(SECONDS, process.kill)
    late.start()
    try:
        if not any(text in line for line in process.stderr):
            fail(f"'{text}': not said")
    finally:
        late.cancel()


def check_head(command, program, environment, folder):
    """A screen shows a ball where the geometry of the room says for a head of sensor 1."""
    write_files(folder)
    port, head, file = free_port(), (0.5, 1.4, 0.1), folder / "room.json"
    keys = f'"tracker": "Wand@127.0.0.1:{port}#1", "address": "tcp://127.0.0.1:{free_port()}"'
    file.write_text(file.read_text(encoding="ascii").replace('"wait"', keys + ', "wait"'), encoding="ascii")
    camera = ",".join(str(x) for x in CAMERA_EYE + CAMERA_TARGET)
    words = ["scene.json", "--screens", "room.json", "--paused", "--size", "200,150", "--camera", camera,
             "--screenshot", "room.png"]
    master = start(command, words, environment, folder)
    try:
        with Server(program, port) as server:
            wait_for_window("tetwarp screen: front", environment)
            server.say(f"pose 1 {' '.join(map(str, head))} 0 0 0 1")
            wait_for_line(master, "the head is tracked")
            end(master, "master")
    finally:
        master.kill()
    x, y = seen("front", BALLS["blue"][0], head=head)
    check_blob(pixels_of(folder / "room_front.png")[1], "blue", (PIXELS * x, PIXELS * y))


def check_wand(command, program, environment, folder):
    port = free_port()
    (folder / "scene.json").write_text(SCENE.replace("TISSUE", write_tissue(folder)), encoding="ascii")
    words = ["--paused", "--record", "input.txt", "--devices", f"wand=Wand@127.0.0.1:{port}"]
    with Window(command, words, environment, folder) as window:
        window.do(f"mousemove 5 {SIZE[1] - 5}")
        lost = window.picture()
        with Server(program, port) as server:
            server.say(f"pose 0 0 {LOW} 0 0 0 0 1")
            shown = window.until("a ray", lambda rows: rays(rows) > 10)
            pull(window, server)
        gone = window.until("the server has ended", lambda rows: rays(rows) == 0)
        with Server(program, port) as server:
            server.say(f"pose 0 0 {LOW} 0 0 0 0 1")
            again = window.until("a ray again", lambda rows: rays(rows) > 10)
        window.close()
    lines = [changed_pixels(third_line(rows), third_line(lost)) for rows in (gone, shown, again)]
    print(f"third line: {dark(third_line(lost))} pixels without a server; {lines[0]} others when it has ended, "
          f"{lines[1:]} while it is there")
    if dark(third_line(lost)) < 100 or lines[0] > 20 or min(lines[1:]) < 100:
        fail("the window does not say when the server is lost")
    check_record((folder / "input.txt").read_text(encoding="ascii"))


def main():
    command, program = (str(Path(word).resolve()) for word in sys.argv[1:3])
    missing = [tool for tool in ("Xvfb", "xdotool") if not shutil.which(tool)]
    if missing:
        print(f"skipped: {' and '.join(missing)} not found; apt install xvfb xdotool")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="tetwarp-wand-") as name, Display() as environment:
        check_wand(command, program, environment, Path(name))
        check_head(command, program, environment, Path(name))


if __name__ == "__main__":
    main()
