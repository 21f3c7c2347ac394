"""How fast the window steps and draws while the mouse pulls, without a graphics processor: scenes that
ship in Xvfb, with events of xdotool.

    python3 bench/view/rates.py build/release/tetwarp RESULTS.json [--seconds S] [--scenes NAME,...]

prints a table and writes it with the load of the machine before and after each scene. Run it alone: a
scene takes about S seconds.
"""
import argparse
import datetime
import json
import math
import os
import re
import subprocess
import tempfile

SIZE = (800, 600)
WAIT = 60  # seconds, for what should end at once
SCENES = {  # options, and the pixel where the mouse takes something
    "torso": ([], (400, 330)),
    "shoulder": (["--max-step-seconds", "0.02"], (400, 250)),
    "candy": ([], (400, 420)),
    "mouth": ([], (400, 260)),
}
PROCESSOR = re.compile(r"processor time: (\d+) steps of ([\d.]+) ms, (\d+) warps of ([\d.]+) ms, "
                       r"(\d+) pictures of ([\d.]+) ms")
WALL = re.compile(r"wall time: ([\d.]+) steps/s in ([\d.]+) s, (\d+) over their time; ([\d.]+) pictures/s")
DELAY = re.compile(r"input to picture: (\d+) pulls, (\d+) ms in the mean, (\d+) at most")


def start_display():
    """@returns the server and its name"""
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0",
                               f"{SIZE[0]}x{SIZE[1]}x24", "-noreset", "-nolisten", "tcp"],
                              pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as numbers:
        return server, ":" + numbers.readline().strip()


def measure(command, name, seconds, environment, folder):
    options, (x, y) = SCENES[name]
    before = os.getloadavg()[0]
    window = subprocess.Popen(
        [command, "view", name, "--size", f"{SIZE[0]},{SIZE[1]}", "--timing", "--threads", "1",
         "--record", "input.txt", *options],
        env=environment, cwd=folder, stdout=subprocess.PIPE, text=True)
    steps = [f"search --sync --onlyvisible --name tetwarp:.{name} windowmove %1 0 0 "
             f"windowfocus --sync %1 mousemove {x} {y} mousedown 1"]
    for n in range(round(25 * seconds)):  # circles, 25 places a second
        angle = 2 * math.pi * n / 50
        steps.append(f"mousemove {x + round(40 * math.sin(angle))} {y + round(25 * math.cos(angle)) - 25} "
                     "sleep 0.04")
    try:
        subprocess.run(["xdotool", *" ".join(steps).split(), "mouseup", "1", "keydown", "Escape"],
                       env=environment, check=True, stdout=subprocess.DEVNULL,
                       timeout=2 * seconds + WAIT)
        printed = window.communicate(timeout=WAIT)[0]
        subprocess.run(["xdotool", "keyup", "Escape"], env=environment, check=True, timeout=WAIT)
    except subprocess.TimeoutExpired as error:
        raise SystemExit(f"{name}: {error.cmd[0]} has not ended after {error.timeout:g} s") from None
    except subprocess.CalledProcessError as error:
        raise SystemExit(f"{name}: xdotool: status {error.returncode}") from None
    finally:
        window.kill()
        window.wait()
    if window.returncode != 0:
        raise SystemExit(f"{name}: status {window.returncode}")
    with open(os.path.join(folder, "input.txt"), encoding="ascii") as record:
        if " grab " not in record.read():
            raise SystemExit(f"{name}: nothing is at {x}, {y}")
    count, step, warps, warp, pictures, picture = PROCESSOR.search(printed).groups()
    rate, wall, late, drawn = WALL.search(printed).groups()
    delay = DELAY.search(printed)
    if delay is None:
        raise SystemExit(f"{name}: no pull reached a picture in {seconds:g} s; give more --seconds")
    pulls, mean, most = delay.groups()
    return {"steps": int(count), "steps_per_second": float(rate), "late_steps": int(late),
            "pictures": int(pictures), "pictures_per_second": float(drawn), "seconds": float(wall),
            "processor_ms": {"step": float(step), "warp": float(warp) if int(warps) else None,
                             "picture": float(picture)},
            "input_to_picture_ms": {"pulls": int(pulls), "mean": int(mean), "most": int(most)},
            "load": [round(before, 2), round(os.getloadavg()[0], 2)]}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("command")
    parser.add_argument("results")
    parser.add_argument("--seconds", type=float, default=15)
    parser.add_argument("--scenes", default=",".join(SCENES))
    arguments = parser.parse_args()
    command = os.path.abspath(arguments.command)
    server, display = start_display()
    rows = {}
    try:
        with tempfile.TemporaryDirectory() as folder:
            for name in arguments.scenes.split(","):
                rows[name] = measure(command, name, arguments.seconds,
                                     os.environ | {"DISPLAY": display}, folder)
    finally:
        server.terminate()
        server.wait()
    version = subprocess.run([command, "--version"], capture_output=True, text=True).stdout.strip()
    folder = os.path.dirname(os.path.abspath(__file__))
    commit = subprocess.run(["git", "-C", folder, "rev-parse", "--short", "HEAD"], capture_output=True,
                            text=True).stdout.strip()
    with open("/proc/cpuinfo", encoding="utf8") as cpuinfo:
        model = re.search("model name.*: (.*)", cpuinfo.read())
    context = {"date": str(datetime.date.today()), "version": version, "commit": commit,
               "processor": model.group(1) if model else "unknown", "size": SIZE,
               "processors": os.cpu_count(), "threads": 1}
    with open(arguments.results, "w", encoding="ascii") as file:
        json.dump({"context": context, "rows": rows}, file, indent=1)
        file.write("\n")
    print("| scene | steps/s | late | pictures/s | step | warp | picture | input to picture | load |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, row in rows.items():
        spent = row["processor_ms"]
        print(f"| `{name}` | {row['steps_per_second']:.0f} | {row['late_steps']} of {row['steps']} | "
              f"{row['pictures_per_second']:.1f} | {spent['step']:.1f} | {spent['warp'] or ''} | "
              f"{spent['picture']:.0f} | {row['input_to_picture_ms']['mean']} | "
              f"{row['load'][0]} to {row['load'][1]} |")


if __name__ == "__main__":
    main()
