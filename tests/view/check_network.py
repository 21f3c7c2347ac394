#!/usr/bin/env python3
"""A room over a network that is slow and loses packets: namespaces joined by a pair of interfaces.

    check_network.py COMMAND    exit status 77 where namespaces, such a wire, Xvfb or xdotool are missing

The master is on one side and two screens on the other. One joins late, is killed, and joins again;
then the other does. At the end both show what the geometry of the room says.
"""
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from check_screens import (BALLS, CAMERA_EYE, CAMERA_TARGET, CORNERS, EYE, FOCUS, PIXELS, check_blob,
                           seen, start, wait_for_window)
from check_window import SECONDS, Display, fail, pixels_of

INSIDE = "TETWARP_NETWORK_TEST"  # set in the namespace
HERE, THERE, PORT = "10.77.0.1", "10.77.0.2", 5611
SIDE = "far"  # name of the other namespace
MOST_BYTES = 2000  # of a frame of three rigid balls: poses of four points each


def run(words, **options):
    return subprocess.run(words, timeout=SECONDS, check=True, **options)


def write_files(folder):
    bodies = ",".join(
        f"""{{"name": "{name}", "kind": "rigid", "shape": {{"type": "ellipsoid",
             "radii": [{radius}, {radius}, {radius}]}}, "density": 1000,
             "pose": {{"position": {list(center)}}}}}"""
        for name, (center, radius) in BALLS.items())
    (folder / "scene.json").write_text(
        f"""{{"tetwarp_scene": 1, "time_step": 0.01, "duration": 1, "gravity": [0, 0, 0],
              "bodies": [{bodies}]}}""", encoding="ascii")
    screens = ",".join(
        f"""{{"name": "{name}", "lower_left": {list(CORNERS[name][0])},
             "lower_right": {list(CORNERS[name][1])}, "upper_right": {list(CORNERS[name][2])},
             "window": [{PIXELS * n}, 0, {PIXELS}, {PIXELS}], "host": "far"}}"""
        for n, name in enumerate(("front", "right")))
    (folder / "room.json").write_text(
        f"""{{"tetwarp_room": 1, "observer": {list(EYE)}, "focus": {FOCUS}, "wait": 5,
              "screens": [{screens}]}}""", encoding="ascii")


def made(words):
    run(words, capture_output=True)


def join_networks():
    """A wire to another namespace, with delay and loss in both directions."""
    made(["mount", "-t", "tmpfs", "tmpfs", "/run"])
    made(["ip", "link", "set", "lo", "up"])
    made(["ip", "netns", "add", SIDE])
    made(["ip", "link", "add", "near", "type", "veth", "peer", "name", "wire", "netns", SIDE])
    made(["ip", "addr", "add", f"{HERE}/24", "dev", "near"])
    made(["ip", "link", "set", "near", "up"])
    for words in (["addr", "add", f"{THERE}/24", "dev", "wire"], ["link", "set", "wire", "up"]):
        made(["ip", "-n", SIDE, *words])
    netem = ["root", "netem", "delay", "5ms", "loss", "2%"]
    # Without netem a narrow wire with a short queue, which delays packets and drops what is too much.
    narrow = ["root", "tbf", "rate", "8mbit", "burst", "4kb", "limit", "12kb"]
    for prefix, wire in (([], "near"), (["-n", SIDE], "wire")):
        done = subprocess.run(["tc", *prefix, "qdisc", "add", "dev", wire, *netem], timeout=SECONDS,
                              capture_output=True)
        if done.returncode != 0:
            made(["tc", *prefix, "qdisc", "add", "dev", wire, *narrow])


def dropped_packets():
    text = run(["tc", "-s", "qdisc", "show", "dev", "near"], capture_output=True, text=True).stdout
    return int(re.search(r"dropped (\d+)", text).group(1))


def screen(command, name, environment, folder):
    words = ["ip", "netns", "exec", SIDE, command, "view", "--join", f"tcp://{HERE}:{PORT}", "--screen",
             name, "--key", "room_screen.key", "--screenshot", f"far_{name}.png"]
    return subprocess.Popen(words, env=environment, cwd=folder, stderr=subprocess.PIPE, text=True)


def end(process, what):
    process.send_signal(signal.SIGTERM)
    if process.wait(SECONDS) != 0:
        fail(f"{what}: status {process.returncode}: {process.stderr.read()}")


def check_status(text):
    """The line of the master about its screens."""
    found = re.search(r"2 of 2 screens   ([\d.]+) kB a frame   (\d+) frames.*", text)
    if not found:
        fail(f"master: no line about two screens in\n{text}")
    print(found.group(0), f"  {dropped_packets()} packets were dropped")
    if not 0 < 1000 * float(found.group(1)) <= MOST_BYTES:
        fail(f"master: {found.group(1)} kB a frame")
    if int(found.group(2)) < 10:
        fail(f"master: {found.group(2)} frames")
    if "bad messages" in found.group(0):
        fail(f"master: {found.group(0)}")


def check_network(command, environment, folder):
    run([command, "view", "--make-keys", "room"], cwd=folder)
    camera = ",".join(str(x) for x in CAMERA_EYE + CAMERA_TARGET)
    master = start(command, ["scene.json", "--screens", "room.json", "--address",
                             f"tcp://near:{PORT}", "--key", "room.key", "--size", "200,150", "--camera",
                             camera, "--timing"], environment, folder, stdout=subprocess.PIPE)
    screens = []
    try:
        screens.append(screen(command, "front", environment, folder))
        wait_for_window("tetwarp screen: front", environment)
        for n in range(2):  # late, and again
            screens.append(screen(command, "right", environment, folder))
            wait_for_window("tetwarp screen: right", environment)
            if n == 0:
                screens[-1].kill()
                screens[-1].wait(SECONDS)
        screens[0].kill()
        screens[0].wait(SECONDS)
        screens.append(screen(command, "front", environment, folder))
        wait_for_window("tetwarp screen: front", environment)
        master.send_signal(signal.SIGTERM)
        text = master.communicate(timeout=SECONDS)[0]
        if master.returncode != 0:
            fail(f"master: status {master.returncode}")
        check_status(text)
        for process in screens[-2:]:
            end(process, "screen")
    finally:
        for process in (*screens, master):
            process.kill()
    for name, ball in (("front", "blue"), ("right", "green")):
        x, y = seen(name, BALLS[ball][0])
        check_blob(pixels_of(folder / f"far_{name}.png")[1], ball, (PIXELS * x, PIXELS * y))


def main():
    command = str(Path(sys.argv[1]).resolve())
    missing = [tool for tool in ("Xvfb", "xdotool", "ip", "tc", "unshare") if not shutil.which(tool)]
    if missing:
        print(f"skipped: {' and '.join(missing)} not found; apt install xvfb xdotool iproute2")
        sys.exit(77)
    own = ["unshare", "--net", "--mount"] + ([] if os.geteuid() == 0 else ["--map-root-user"])
    if INSIDE not in os.environ:
        if subprocess.run([*own, "mount", "-t", "tmpfs", "tmpfs", "/run"], timeout=SECONDS,
                          capture_output=True).returncode != 0:
            print("skipped: network namespaces are not permitted")
            sys.exit(77)
        os.execvpe(own[0], [*own, sys.executable, "-B", *sys.argv], os.environ | {INSIDE: "1"})
    try:
        join_networks()
    except subprocess.CalledProcessError as error:
        print(f"skipped: {' '.join(error.cmd)}: {error.stderr.decode().strip()}")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="tetwarp-network-") as name:
        folder = Path(name)
        write_files(folder)
        with Display() as environment:
            check_network(command, environment, folder)


if __name__ == "__main__":
    main()
