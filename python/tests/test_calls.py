"""Long calls: progress, Ctrl-C, threads, objects that are closed."""

import signal
import threading
import time

import numpy as np
import pytest

import tetwarp


@pytest.fixture
def slow():
    """A Warper and positions whose step takes about a second."""
    volume = tetwarp.phantom(shape=(150, 150, 150))
    mesh = tetwarp.lattice_mesh(volume, cells=6)
    warper = tetwarp.Warper(volume, *mesh, interpolator="lanczos", threads=1, backend="cpu")
    return warper, tetwarp.deform(*mesh, amount=0.5)


def test_progress_grows_to_one(volume, mesh, twisted):
    seen = []

    tetwarp.warp(volume, *mesh, twisted, progress=seen.append)

    assert seen == sorted(seen) and seen[-1] == 1.0 and len(seen) > 1


def test_progress_ends_a_step(volume, mesh, twisted):
    with tetwarp.Warper(volume, *mesh) as warper:
        with pytest.raises(tetwarp.Cancelled):
            warper(twisted, progress=lambda fraction: False)

        again = warper(twisted)

    assert np.array_equal(again.volume, tetwarp.warp(volume, *mesh, twisted).volume)


@pytest.mark.parametrize("answer", [False, np.bool_(False)])
def test_only_false_of_a_callback_ends_a_step(answer, volume, mesh, twisted):
    with pytest.raises(tetwarp.Cancelled):
        tetwarp.warp(volume, *mesh, twisted, progress=lambda fraction: answer)
    for other in (None, True, 0, "", np.bool_(True)):
        tetwarp.warp(volume, *mesh, twisted, progress=lambda fraction, it=other: it)


def test_an_exception_of_the_callback_arrives(volume, mesh, twisted):
    def fail(fraction):
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        tetwarp.warp(volume, *mesh, twisted, progress=fail)


def test_ctrl_c_ends_a_step_before_its_end(slow):
    warper, deformed = slow
    start = time.monotonic()
    warper(deformed)
    whole = time.monotonic() - start
    previous = signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.setitimer(signal.ITIMER_REAL, 0.1 * whole)
    start = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            warper(deformed)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, previous)

    assert time.monotonic() - start < 0.7 * whole


def test_other_threads_run_during_a_step(slow):
    warper, deformed = slow
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    warper(deformed)
    end = time.monotonic()
    stop.set()
    thread.join()

    assert sum(start < tick < end for tick in ticks) >= 5


def test_a_second_call_of_the_same_object_is_refused(volume, mesh, twisted):
    with tetwarp.Warper(volume, *mesh) as warper:
        with pytest.raises(RuntimeError, match="Warper: a call of this object is running"):
            warper(twisted, progress=lambda fraction: warper(twisted))


def test_a_closed_warper_says_so(volume, mesh, twisted):
    with tetwarp.Warper(volume, *mesh) as warper:
        assert "20, 24, 32" in repr(warper)

    with pytest.raises(RuntimeError, match="Warper: it is closed"):
        warper(twisted)
    assert "closed" in repr(warper)


def test_results_say_what_they_are(volume, mesh, twisted):
    result = tetwarp.warp(volume, *mesh, twisted, outputs="mask")

    assert "float32, with mask; " in repr(result) and "% of 15360 voxels" in repr(result)
    with pytest.raises(AttributeError, match=r"ask for it by outputs=\('owner',\)"):
        result.owner


def _within(start, calls):
    """What each call gives while `start` runs, in its callback."""
    answers = {}

    def look(*_):
        for name, call in calls.items():
            try:
                call()
                answers[name] = "done"
            except RuntimeError as error:
                answers[name] = str(error)

    start(look)
    return answers


def test_whatever_changes_in_a_step_is_not_read_meanwhile(volume, mesh, twisted):
    """A step of a Warper ends with a record in its report, which may take other memory for it."""
    warper = tetwarp.Warper(volume, *mesh)
    warper(twisted)
    answers = _within(lambda progress: warper(twisted, progress=progress), {
        "report": lambda: warper.report, "call": lambda: warper(twisted),
        "grid": lambda: warper.grid, "repr": lambda: repr(warper)})

    assert answers.pop("grid") == answers.pop("repr") == "done"
    assert set(answers.values()) == {"Warper: a call of this object is running"}
    assert len(warper.report["steps"]) == 2
    simulator = tetwarp.Simulator(tetwarp.shipped_scene("cantilever"), threads=1)
    state = simulator.checkpoint()
    per_body = ("mesh", "positions", "velocities", "surface", "volume", "jacobians", "stresses")
    calls = {name: lambda name=name: getattr(simulator, name)(0) for name in per_body}
    calls |= {name: lambda name=name: getattr(simulator, name)() for name in (
        "step", "record", "contacts", "checkpoint")}
    calls |= {name: lambda name=name: getattr(simulator, name) for name in (
        "time", "time_step", "step_index", "step_count", "thickness", "backend", "obstacle_names")}
    calls |= {"restore": lambda: simulator.restore(state),
              "add_handle": lambda: simulator.add_handle("h", 0, (0, 0, 0), 1.0),
              "move_handle": lambda: simulator.move_handle("h", (0, 0, 0)),
              "release_handle": lambda: simulator.release_handle("h"),
              "move_script": lambda: simulator.move_script("beam", (0, 0, 0))}
    public = {name for name in dir(simulator) if not name.startswith("_")}
    assert public - set(calls) == {"names", "run"}

    answers = _within(lambda progress: simulator.step(progress=progress), calls)

    assert answers.keys() == calls.keys()
    assert all("of this object is running" in text for text in answers.values()), answers
    solver = tetwarp.ContactSolver()
    problem = tetwarp.ContactProblem(delassus=np.eye(3), free_velocity=[-1, 2, 0], friction=[0.5])
    answers = _within(lambda progress: solver.solve(problem, progress=progress),
                      {"solve": lambda: solver.solve(problem)})
    assert answers == {"solve": "ContactSolver: a call of this object is running"}


def test_the_report_is_whole_while_another_thread_steps(single_tet):
    points, cells = single_tet
    warper = tetwarp.Warper(np.ones((4, 4, 4), np.uint8), points, cells, threads=1)
    done, stepped = threading.Event(), []

    def work():
        for _ in range(3000):
            try:
                warper(points)
                stepped.append(True)
            except RuntimeError:  # the report is being read
                pass
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        try:
            steps = warper.report["steps"]
        except RuntimeError:
            continue
        numbers = [step["step"] for step in steps]
        assert not numbers or numbers == list(range(numbers[0], numbers[0] + len(numbers)))
        assert all(step["counts"]["voxels"] == 64 for step in steps)
    thread.join()

    assert warper.report["steps"][-1]["step"] == len(stepped) - 1
