"""Simulations."""

import gc
import json
import pickle
import re

import numpy as np
import pytest

import tetwarp


def _beam(**changes):
    scene = tetwarp.shipped_scene("cantilever")
    scene["bodies"][0]["lattice"] = {"cells": [10, 2, 2]}
    return {**scene, **changes}


def _dropped():
    """An elastic box that falls on a plane."""
    return {
        "tetwarp_scene": 1, "time_step": 0.01, "duration": 0.5,
        "bodies": [{
            "name": "box", "kind": "fem", "shape": {"type": "box", "half": [0.1, 0.1, 0.1]},
            "pose": {"position": [0, 0, 0.102]}, "lattice": {"cells": [2, 2, 2]},
            "material": {"E": 1e5, "nu": 0.3, "density": 1000},
        }],
        "obstacles": [{"name": "floor", "plane": {"normal": [0, 0, 1], "point": [0, 0, 0]}}],
    }


def test_a_beam_bends_under_its_weight():
    simulator = tetwarp.Simulator(_beam())
    rest = simulator.positions("beam")

    assert simulator.step(5)

    moved = simulator.positions(0)
    assert moved[:, 2].min() < rest[:, 2].min() - 1e-4
    assert simulator.step_index == 5 and simulator.time == pytest.approx(5 * simulator.time_step)
    record = simulator.record()
    assert record.converged and record.energy.kinetic > 0 and record.bodies[0].center.shape == (3,)
    assert "step 5 of" in repr(simulator) and "converged True" in repr(record)
    assert pickle.loads(pickle.dumps(record)).time == record.time


def test_scenes_come_from_dicts_paths_and_numbers_of_numpy(tmp_path):
    scene = _beam(gravity=np.array([0, 0, -9.81]), duration=np.float64(0.1))
    (tmp_path / "scene.json").write_text(json.dumps(_beam(gravity=[0, 0, -9.81], duration=0.1)))

    first, second = tetwarp.Simulator(scene), tetwarp.Simulator(tmp_path / "scene.json")
    first.step(3), second.step(3)

    assert first.checkpoint() == second.checkpoint()


def test_a_checkpoint_goes_on_with_the_same_bits():
    simulator = tetwarp.Simulator(_beam())
    simulator.step(3)
    state = simulator.checkpoint()
    simulator.step(4)
    expected = simulator.positions("beam")

    other = tetwarp.Simulator(_beam())
    other.restore(state)
    other.step(4)

    assert np.array_equal(other.positions("beam"), expected)
    with pytest.raises(ValueError):
        other.restore(b"something else")


def test_contacts_carry_the_weight():
    simulator = tetwarp.Simulator(_dropped())
    for _ in simulator.run():
        pass

    contacts = simulator.contacts()

    assert len(contacts) >= 4 and repr(contacts) == f"Contacts({len(contacts)})"
    assert np.allclose(np.abs(contacts.normal[:, 2]), 1)
    assert simulator.obstacle_names == ["floor"] and set(contacts.body_b) == {1}
    weight = 9.81 * 1000 * 0.2**3
    assert simulator.record().bodies[0].contact_force[2] == pytest.approx(weight, rel=0.2)


def test_a_callback_ends_a_step_without_effect():
    simulator = tetwarp.Simulator(_dropped())
    simulator.step(2)
    before = simulator.positions("box")

    assert simulator.step(progress=lambda *_: False) is False
    assert simulator.step_index == 2 and np.array_equal(simulator.positions("box"), before)

    def ctrl_c(step, time, iterations):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulator.step(progress=ctrl_c)
    assert simulator.step_index == 2 and np.array_equal(simulator.positions("box"), before)
    assert simulator.step()


def test_state_is_not_read_within_a_step():
    simulator = tetwarp.Simulator(_dropped())

    with pytest.raises(RuntimeError, match="a step of this object is running"):
        simulator.step(progress=lambda *_: simulator.positions("box") is None)


def test_handles_are_added_while_a_scene_runs():
    simulator = tetwarp.Simulator(_beam())
    simulator.step(2)
    end = simulator.positions("beam")[:, 0].argmax()
    center = simulator.positions("beam")[end]

    simulator.add_handle("finger", "beam", center, stiffness=5000)
    simulator.move_handle("finger", (0, 0, 0.1))
    simulator.step(10)

    assert simulator.positions("beam")[end, 2] > center[2] + 0.01
    with pytest.raises(ValueError, match="handle.stiffness"):
        simulator.add_handle("finger", "beam", center, stiffness=0)


def test_handles_are_moved():
    scene = _beam(handles=[{
        "name": "lift", "handle": "beam", "select": {"half_space": [1, 0, 0, 0.499]},
        "stiffness": 5000}])
    if "half" in scene["bodies"][0]["shape"]:
        end = scene["bodies"][0]["shape"]["half"][0]
        scene["handles"][0]["select"]["half_space"][3] = end - 1e-6
    simulator = tetwarp.Simulator(scene)
    free = tetwarp.Simulator(_beam())

    simulator.move_handle("lift", (0, 0, 0.1))
    simulator.step(10), free.step(10)

    assert simulator.positions("beam")[:, 2].max() > free.positions("beam")[:, 2].max()
    simulator.release_handle("lift")
    with pytest.raises(ValueError, match="pull"):
        simulator.move_handle("pull", (0, 0, 0))


@pytest.fixture
def orange(tmp_path):
    volume = tetwarp.phantom("orange", (24, 24, 24), spacing=(0.004, 0.004, 0.004))
    tetwarp.write(tmp_path / "orange.vtkhdf", volume)
    scene = {
        "tetwarp_scene": 1, "time_step": 0.01, "duration": 0.2,
        "bodies": [{
            "name": "orange", "kind": "fem", "volume": {"file": "orange.vtkhdf", "threshold": 0.05},
            "lattice": {"cells": [3, 3, 3]},
            "material": {"E": 1e5, "nu": 0.3, "density": 900},
        }],
    }
    return tetwarp.Simulator(scene, folder=tmp_path), volume


def test_the_image_of_a_body_follows_it(orange):
    simulator, volume = orange
    image = simulator.volume("orange")
    simulator.step(3)

    result = tetwarp.warp(image, *simulator.mesh("orange"), simulator.positions("orange"),
                          reference=image, outputs="mask")

    assert np.array_equal(image.array, volume.array)
    assert result.mask.any() and result.volume.max() > 0.5


def test_the_image_of_a_body_is_shared_and_outlives_the_simulator(orange):
    simulator, volume = orange
    first, second = simulator.volume("orange"), simulator.volume(0)
    assert np.shares_memory(first.array, second.array) and not first.array.flags.writeable
    orange_array = first.array
    del simulator, first, second
    gc.collect()

    assert np.array_equal(orange_array, volume.array)


@pytest.mark.parametrize("scene, error, text", [
    (3, ValueError, "scene: expected a dict or the path of a file, got int"),
    ({"tetwarp_scene": 1}, tetwarp.IoError, "scene"),
    ("/no/such/scene.json", tetwarp.IoError, "scene.json"),
    ({"tetwarp_scene": {1}}, ValueError, "scene: set is no value of JSON"),
])
def test_errors_name_what_is_wrong(scene, error, text):
    with pytest.raises(error, match=text):
        tetwarp.Simulator(scene)


def test_bodies_are_named():
    simulator = tetwarp.Simulator(_dropped())

    for body, text in (("ball", "body: 'ball' is not one of box"), (7, "body: expected 0 to 0")):
        with pytest.raises(ValueError, match=text):
            simulator.positions(body)
    with pytest.raises(ValueError, match="is not made of an image"):
        simulator.volume("box")
    surface = simulator.surface("box")
    assert surface.triangles.max() < len(surface.points)
    assert simulator.jacobians("box").shape == simulator.stresses("box").shape


def test_a_step_may_be_given_a_time():
    scene = tetwarp.shipped_scene("cantilever")
    free, limited = (tetwarp.Simulator(scene, max_step_seconds=s) for s in (float("inf"), 1e6))
    assert free.step(3) and limited.step(3)
    assert (free.positions("beam") == limited.positions("beam")).all()
    assert limited.record().out_of_time is False
    with pytest.raises(ValueError, match="max_step_seconds: expected more than 0"):
        tetwarp.Simulator(scene, max_step_seconds=0)


@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf, np.float32("nan")])
@pytest.mark.parametrize("key, place", [
    ("duration", lambda scene, x: scene.update(duration=x)),
    ("gravity[2]", lambda scene, x: scene.update(gravity=[0, 0, x])),
    ("gravity[1]", lambda scene, x: scene.update(gravity=np.array([0, x, 0]))),
    ("bodies[0].material.E", lambda scene, x: scene["bodies"][0]["material"].update(E=x)),
])
def test_a_number_that_is_none_is_named_by_its_key(key, place, number):
    scene = tetwarp.shipped_scene("cantilever")
    place(scene, number)

    with pytest.raises(ValueError, match=re.escape(f"scene: {key}: expected a finite number")):
        tetwarp.Simulator(scene)


def test_masks_of_scenes_are_refused():
    gravity = np.ma.array([0, 0, -9.81], mask=[0, 0, 1])
    for masked in (gravity, list(gravity), [gravity[0], 0, np.ma.masked]):
        with pytest.raises(ValueError, match="scene: masked elements"):
            tetwarp.Simulator({**tetwarp.shipped_scene("cantilever"), "gravity": masked})


def test_no_folder_is_the_current_one(tmp_path, monkeypatch):
    scene = tetwarp.shipped_scene("cantilever")
    for folder in (None, "", ".", tmp_path, str(tmp_path).encode()):
        assert tetwarp.Simulator(scene, folder=folder, threads=1).names == ["beam"]
