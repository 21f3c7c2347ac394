"""Long runs, threads, forks and sub-interpreters."""

import gc
import os
import resource
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest

import tetwarp


def peak_of(code):
    """Peak of memory of a new process that runs `code` [byte]; it prints nothing else."""
    program = f"import resource, numpy as np, tetwarp\n{code}\n" \
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    done = subprocess.run([sys.executable, "-c", program], text=True, capture_output=True,
                          env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}, check=False)
    assert done.returncode == 0, done.stderr
    return 1024 * int(done.stdout)


def test_a_warp_holds_source_and_output_and_no_copy_of_either():
    """128 MiB each: a copy of one would be as much again."""
    setup = """
shape = (256, 256, 512)
samples = np.ones(shape, np.float32)
tet = np.array([(0, 0, 0), (90, 0, 0), (0, 90, 0), (0, 0, 90.0)])
out = np.zeros(shape, np.float32)
out[:] = 1
"""
    arrays = peak_of(setup)
    warped = peak_of(setup + "tetwarp.warp(samples, tet, [(0, 1, 2, 3)], tet + 0.5, out=out)")

    assert warped - arrays < 24 * 2**20


def resident():
    """Memory of this process [KiB]."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize() // 1024


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="no /proc")
@pytest.mark.parametrize("keeps_warper, count", [(False, 3000), (True, 10000)])
def test_memory_stays_the_same(single_tet, keeps_warper, count):
    """A Warper keeps counts and times of its last 1000 steps at most."""
    points, cells = single_tet
    samples = np.random.default_rng(1).random((6, 6, 6), np.float32)
    warper = tetwarp.Warper(samples, points, cells)
    places = [points + 0.01 * number for number in range(7)]

    def rounds(count):
        for number in range(count):
            moved = places[number % 7]
            warper(moved) if keeps_warper else tetwarp.warp(
                samples, points, cells, moved, threads=1)
        gc.collect()
        return resident()

    warm = rounds(1100)

    assert rounds(count) - warm < 256  # KiB: 26 bytes per step of 10,000


def test_a_report_has_the_sums_of_all_steps_and_the_last_ones(single_tet):
    points, cells = single_tet
    warper = tetwarp.Warper(np.ones((4, 4, 4), np.uint8), points, cells, threads=1)
    count = 2100
    covered = [warper(points if number % 3 else 0.5 * points).report["counts"]["covered"]
               for number in range(count)]

    report = warper.report

    assert report["counts"]["covered"] == sum(covered)
    numbers = [step["step"] for step in report["steps"]]
    assert numbers == list(range(numbers[0], count)) and 500 <= len(numbers) <= 1000
    assert [step["counts"]["covered"] for step in report["steps"]] == covered[numbers[0]:]


def test_arrays_may_be_deleted_while_they_are_in_use(volume, mesh, twisted):
    expected = tetwarp.warp(volume, *mesh, twisted).volume
    held = {"samples": volume.array.copy(), "moved": twisted.copy()}
    warper = tetwarp.Warper(held["samples"], *mesh, affine=volume.affine)

    def delete(fraction):
        if held:
            held.clear()
            gc.collect()
            np.full(volume.shape, -1, np.float32)  # would take freed memory
        return True

    result = warper(held["moved"], progress=delete)

    assert not held and np.array_equal(result.volume, expected)


def test_threads_warp_side_by_side_with_objects_of_their_own(volume, mesh):
    steps = [tetwarp.deform(*mesh, kind="twist", amount=0.1 * n) for n in range(1, 5)]
    expected = [tetwarp.warp(volume, *mesh, step).volume for step in steps]
    results = [None] * len(steps)

    def work(number):
        with tetwarp.Warper(volume, *mesh) as warper:
            for _ in range(5):
                results[number] = warper(steps[number]).volume

    threads = [threading.Thread(target=work, args=(n,)) for n in range(len(steps))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert all(np.array_equal(a, b) for a, b in zip(results, expected))


def test_a_module_that_is_imported_again_lets_processes_fork():
    code = """
import os, signal, sys
import tetwarp
for name in [name for name in sys.modules if name.startswith("tetwarp")]:
    del sys.modules[name]
import tetwarp
signal.alarm(20)
child = os.fork()
if child == 0:
    os._exit(0)
assert os.waitpid(child, 0)[1] == 0
"""
    done = subprocess.run([sys.executable, "-c", code], text=True, capture_output=True, timeout=60,
                          env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}, check=False)
    assert done.returncode == 0, done.stderr



def test_a_fork_warps_on(volume, mesh, twisted):
    expected = tetwarp.warp(volume, *mesh, twisted, threads=2).volume
    warper = tetwarp.Warper(volume, *mesh, threads=2)
    warper(twisted)
    child = os.fork()
    if child == 0:
        same = np.array_equal(tetwarp.warp(volume, *mesh, twisted, threads=2).volume, expected)
        same = same and np.array_equal(warper(twisted).volume, expected)
        os._exit(0 if same else 1)

    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_files_are_opened_read_and_closed_by_several_threads(mesh, tmp_path):
    steps = [mesh.points + 0.25 * number for number in range(4)]
    for number in range(3):
        tetwarp.write(tmp_path / f"{number}.vtkhdf", mesh, deformed=steps)
    found = []

    def work(number):
        for _ in range(40):
            file = tetwarp.MeshFile(tmp_path / f"{number}.vtkhdf")
            found.append(all(map(np.array_equal, file, steps)))
            del file  # closes it while others read

    threads = [threading.Thread(target=work, args=(number,)) for number in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert found == [True] * 120


@pytest.mark.parametrize("work", ["read", "write", "scene", "warp", "points"])
def test_a_fork_goes_on_while_other_threads_are_in_calls(work, volume, mesh, twisted, tmp_path):
    """Children have none of the threads that held a lock or did a part of a loop."""
    paths = [tmp_path / f"{name}.vtkhdf" for name in ("read", "written", "of the child")]
    tetwarp.write(paths[0], volume, compress=9)
    scene = {**tetwarp.shipped_scene("cantilever"), "duration": 0.01}
    call = {
        "read": lambda to: tetwarp.read(paths[0]),
        "write": lambda to: tetwarp.write(to, volume, compress=9),
        "scene": lambda to: tetwarp.Simulator(scene, threads=2).step(),
        "warp": lambda to: tetwarp.warp(volume, *mesh, twisted, threads=2),
        "points": lambda to: tetwarp.transform_points(mesh.points, *mesh, twisted),
    }[work]
    stop = threading.Event()

    def work_on():
        while not stop.is_set():
            call(paths[1])

    thread = threading.Thread(target=work_on)
    thread.start()
    try:
        for _ in range(8):
            child = os.fork()
            if child == 0:
                signal.signal(signal.SIGALRM, signal.SIG_DFL)
                signal.alarm(30)  # ends it where it hangs
                status = 1
                try:
                    call(paths[2])
                    status = 0
                finally:
                    os._exit(status)
            assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    finally:
        stop.set()
        thread.join()


def test_sub_interpreters_are_refused_in_words(tmp_path):
    pytest.importorskip("_interpreters" if sys.version_info >= (3, 13) else "_xxsubinterpreters")
    module = "_interpreters" if sys.version_info >= (3, 13) else "_xxsubinterpreters"
    code = tmp_path / "code.py"
    code.write_text(f"""
import {module} as interpreters
import tetwarp._core
number = interpreters.create()
text = '''
try:
    import importlib.util
    spec = importlib.util.spec_from_file_location("tetwarp._core", {tetwarp._core.__file__!r})
    spec.loader.exec_module(importlib.util.module_from_spec(spec))
except ImportError as error:
    print("refused:", error)
else:
    print("imported")
'''
interpreters.run_string(number, text) if hasattr(interpreters, "run_string") else \\
    interpreters.exec(number, text)
""")

    done = subprocess.run([sys.executable, code], text=True, capture_output=True,
                          env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}, check=False)

    assert done.returncode == 0, done.stderr
    assert "refused:" in done.stdout and "interpreter" in done.stdout


def test_a_program_ends_while_daemon_threads_compute(tmp_path):
    """Python ends such threads where they take the interpreter's lock."""
    code = tmp_path / "code.py"
    code.write_text("""
import threading, tetwarp
volume = tetwarp.phantom(shape=(20, 24, 32))
mesh = tetwarp.lattice_mesh(volume, cells=4)
moved = tetwarp.deform(*mesh)
def warp(progress, warped):
    while True:
        tetwarp.warp(volume, *mesh, moved, progress=progress)
        warped.set()
events = []
for progress in (None, None, lambda fraction: None):
    events.append(threading.Event())
    threading.Thread(target=warp, args=(progress, events[-1]), daemon=True).start()
assert all(event.wait(30) for event in events)
""")

    for _ in range(3):
        done = subprocess.run([sys.executable, code], text=True, capture_output=True, timeout=60,
                              env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}, check=False)
        assert done.returncode == 0 and not done.stderr, done.stderr


def test_a_mesh_file_that_is_dropped_lets_other_threads_run(tmp_path):
    """While another thread reads, here a pipe, which a third thread must open for it to end."""
    code = tmp_path / "drop.py"
    code.write_text(f"""
import os, threading, time
import numpy as np
import tetwarp

mesh, pipe = tetwarp.lattice_mesh(np.ones((8, 8, 8), np.uint8), cells=1), "{tmp_path}/pipe.nii"
tetwarp.write("{tmp_path}/mesh.vtkhdf", mesh)
file = tetwarp.MeshFile("{tmp_path}/mesh.vtkhdf")
os.mkfifo(pipe)

def read():
    try:
        tetwarp.read_header(pipe)
    except tetwarp.IoError as error:
        print(error)

def feed():
    while reader.is_alive():
        try:
            os.close(os.open(pipe, os.O_WRONLY | os.O_NONBLOCK))
            opened.set()
        except OSError:  # nobody reads it now
            time.sleep(0.001)

reader, opened = threading.Thread(target=read), threading.Event()
reader.start()
threading.Thread(target=feed).start()
del file
opened.wait()
print("dropped")
""")
    done = subprocess.run([sys.executable, code], text=True, capture_output=True, timeout=60, check=False,
                          env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)})
    assert done.returncode == 0 and "dropped" in done.stdout, done.stdout + done.stderr
