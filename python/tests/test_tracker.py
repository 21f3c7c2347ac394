"""Contacts from step to step."""

import pickle

import numpy as np
import pytest

import tetwarp

REST = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
DT = 0.01
GLUE = dict(friction=0.4, stiffness=1e6, energy=0.1, viscosity=50, initial_intensity=1)


def found(*places, gap=0.0, first=0):
    """Contacts of body 0 on body 1 at places along x, whose numbers are their features."""
    x = np.array(places, float)
    feature = first + np.arange(len(x))
    zero = np.zeros(len(x))
    return dict(
        keys=np.stack([0 * feature, feature, 0 * feature + 1, feature], 1),
        point_a=np.stack([x, zero, zero + gap], 1), point_b=np.stack([x, zero, zero], 1),
        normal=np.tile((0.0, 0, 1), (len(x), 1)), area=np.full(len(x), 1e-4),
    )


def still(tracker, contacts, bodies=(REST, REST)):
    count = len(tracker.begin_step(contacts, bodies, DT).keys)
    return tracker.end_step(np.zeros((count, 3)), bodies)


def test_contacts_that_adhere_stay_and_others_go():
    tracker = tetwarp.ContactTracker([GLUE])
    still(tracker, {k: v for k, v in found(0, 1).items()})
    tracker = tetwarp.ContactTracker([GLUE], records=tracker.records)
    lifted = (((0, 0, 1e-5), REST[1]), REST)

    contacts = tracker.begin_step(found(), lifted, DT)

    assert contacts.keys.tolist() == [[0, 0, 1, 0], [0, 1, 1, 1]]
    assert not contacts.is_reported.any() and "2, of them 2 kept" in repr(contacts)
    assert np.allclose(contacts.gap[:, 0], 1e-5, rtol=1e-9)
    dry = tetwarp.ContactTracker([dict(friction=0.4)])
    still(dry, found(0, 1))
    assert len(dry.records) == 2
    still(dry, found())
    assert len(dry.records) == 0


def test_a_new_feature_nearby_is_the_same_contact():
    for distance, count in ((5e-4, 1), (5e-3, 2)):
        tracker = tetwarp.ContactTracker([GLUE], match_distance=1e-3)
        still(tracker, found(0))
        still(tracker, found(distance, first=7))
        assert len(tracker.records) == count
        assert tracker.records.keys[-1].tolist() == [0, 7, 1, 7]


def test_the_order_of_reports_does_not_matter():
    contacts = found(0, 0.5, 1)
    turned = {name: rows[::-1] for name, rows in contacts.items()}
    one, other = (tetwarp.ContactTracker([GLUE]) for _ in range(2))

    first, second = (t.begin_step(c, (REST, REST), DT) for t, c in ((one, contacts),
                                                                    (other, turned)))

    for a, b in zip(first, second):
        assert np.array_equal(a, b)


def _pull(tracker, steps):
    """A cube of 1 kg, glued to a plate by four contacts, pulled up by more than its weight: its
    heights and intensities."""
    corners = np.array([(x, y, 0.0) for x in (-1, 1) for y in (-1, 1)]) * 0.05
    height, speed, heights = 0.0, 0.0, []
    jacobian = np.zeros((12, 3))
    for _ in range(steps):
        bodies = (((0, 0, height), REST[1]), REST)
        contacts = tracker.begin_step(
            dict(keys=[(0, c, 1, c) for c in range(4)], point_a=corners + (0, 0, height),
                 point_b=corners, normal=np.tile((0.0, 0, 1), (4, 1)), area=np.full(4, 1e-3)),
            bodies, DT)
        jacobian[:] = contacts.axes.reshape(-1, 3)
        load = np.array([0, 0, speed + DT * 30.0])
        problem = tracker.fill(tetwarp.ContactProblem(system=np.eye(3), jacobian=jacobian,
                                                      load=load))
        solution = tetwarp.solve_contacts(problem, tolerance=1e-10)
        assert solution.converged
        speed = solution.body_velocity[2]
        height += DT * speed
        step = tracker.end_step(solution, (((0, 0, height), REST[1]), REST))
        heights.append((height, step.intensity.mean(), bool(step.debonded.any())))
    return np.array(heights)


def test_glue_holds_less_than_its_strength_and_then_lets_go():
    strong = _pull(tetwarp.ContactTracker([dict(GLUE, energy=1e3)]), 20)
    weak = _pull(tetwarp.ContactTracker([dict(GLUE, energy=1e-4, viscosity=1)]), 20)

    assert (strong[:, 1] > 0.9).all() and strong[-1, 0] < 0.02  # 30 N on 4e-3 m^2 of 1e6 N/m^3
    assert (np.diff(weak[:, 1]) <= 0).all() and weak[-1, 1] == 0
    assert weak[-1, 0] > 0.3 * 30 * (20 * DT) ** 2  # nearly free flight


def test_a_tracker_goes_on_from_pickled_records_with_the_same_bits():
    whole = tetwarp.ContactTracker([GLUE], match_distance=1e-3)
    still(whole, found(0, 0.3, 1))
    records = pickle.loads(pickle.dumps(whole.records))
    other = tetwarp.ContactTracker([GLUE], match_distance=1e-3, records=records)

    for tracker in (whole, other):
        tracker.begin_step(found(1e-4, 0.3), (((2e-6, 0, 3e-6), REST[1]), REST), DT)
        tracker.end_step(np.full((3, 3), 1e-3), (((2e-6, 0, 4e-6), REST[1]), REST))

    for name, column in whole.records.table.items():
        assert np.array_equal(column, other.records.table[name]), name
    assert (whole.records.impulse != 0).any() and whole.records.has_touched.all()


def test_deformable_bodies_have_vertices():
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0.0)])
    contacts = dict(found(0.25), point_a=[(0.25, 0.25, 0.0)], point_b=[(0.25, 0.25, 0.0)],
                    vertices_a=[(0, 1, 2)], weights_a=[(0.5, 0.25, 0.25)])
    tracker = tetwarp.ContactTracker([GLUE])
    still(tracker, contacts, (vertices, REST))

    kept = tracker.begin_step(found(), (vertices + (0, 0, 1e-5), REST), DT)

    assert np.allclose(kept.point_a, (0.25, 0.25, 1e-5))
    assert kept.weights_a.tolist() == [[0.5, 0.25, 0.25]]
    assert kept.gap[0, 0] == pytest.approx(1e-5)


@pytest.mark.parametrize("change, message", [
    ({"keys": [(0, 0, 1)]}, r"contacts\['keys'\]: expected integers of shape \(1, 4\)"),
    ({"normal": [(0, 0, 2.0)]}, "normal"),
    ({"area": [-1.0]}, "area"),
    ({"area": [1.0, 2.0]}, r"contacts\['area'\]: expected numbers of shape \(1,\)"),
    ({"material": [3]}, "material"),
    ({"speed": [3]}, "contacts: 'speed' is not one of keys"),
    ({"keys": [(0, 0, 9, 0)]}, "9"),
    ({"keys": [(0, 2**40, 1, 0)]}, f"found 0 to {2**40}"),
])
def test_bad_contacts_are_named(change, message):
    with pytest.raises(ValueError, match=message):
        tetwarp.ContactTracker([GLUE]).begin_step({**found(0), **change}, (REST, REST), DT)


def test_bad_bodies_options_and_orders_are_named():
    tracker = tetwarp.ContactTracker()
    contacts = found(0)
    del contacts["normal"]
    with pytest.raises(ValueError, match="contacts: expected 'normal'"):
        tracker.begin_step(contacts, (REST, REST), DT)
    with pytest.raises(ValueError, match=r"bodies\[1\]: rotation w, x, y, z: expected 4"):
        tracker.begin_step(found(0), (REST, ((0, 0, 0), (1, 0, 0))), DT)
    with pytest.raises(ValueError, match="time_step"):
        tracker.begin_step(found(0), (REST, REST), 0)
    with pytest.raises(RuntimeError, match="begin_step"):
        tracker.end_step(np.zeros((1, 3)), (REST, REST))
    with pytest.raises(RuntimeError, match="begin_step"):
        tracker.fill(tetwarp.ContactProblem())
    with pytest.raises(ValueError, match=r"materials\[0\]: 'mu' is not one of friction"):
        tetwarp.ContactTracker([dict(mu=1)])
    with pytest.raises(ValueError, match="integrator: 'rk4' is not one of exact, explicit-euler"):
        tetwarp.ContactTracker(integrator="rk4")
    with pytest.raises(ValueError, match="threads: expected a whole number, got 1.9"):
        tetwarp.ContactTracker(threads=1.9)
    tracker.begin_step(found(0), (REST, REST), DT)
    system, jacobian = np.eye(3), np.ones((6, 3))
    with pytest.raises(ValueError, match="problem: expected a jacobian of 3 rows"):
        tracker.fill(tetwarp.ContactProblem(system=system, jacobian=jacobian, load=np.zeros(3)))
    problem = tracker.fill(tetwarp.ContactProblem(system=system, jacobian=np.eye(3),
                                                  load=np.zeros(3)))
    with pytest.raises(ValueError, match="velocity: the solution has its own"):
        tracker.end_step(tetwarp.solve_contacts(problem), (REST, REST), velocity=np.zeros((1, 3)))
    with pytest.raises(ValueError, match=r"velocity: expected numbers of shape \(1, 3\)"):
        tracker.end_step(np.zeros((1, 3)), (REST, REST), velocity=np.zeros((2, 3)))
    with pytest.raises(ValueError, match=r"solution: impulse: expected numbers of shape \(1, 3\)"):
        tracker.end_step(np.zeros((2, 3)), (REST, REST))


def test_vertices_may_be_rows_in_any_list():
    rows = [(0.0, 0, 0), (1.0, 0, 0), (0.0, 1, 0), (0.0, 0, 1), (1.0, 1, 1)]
    for count in (1, 3, 4, 5):
        found = dict(keys=[(0, 0, 1, 0)], point_a=[rows[0]], point_b=[rows[0]], normal=[(0, 0, 1)],
                     vertices_a=[(0, -1, -1)], weights_a=[(1.0, 0, 0)])
        bits = set()
        for body in (np.array(rows[:count]), rows[:count], tuple(rows[:count])):
            contacts = tetwarp.ContactTracker().begin_step(
                found, [body, ((0, 0, 0), (1, 0, 0, 0))], 0.01)
            bits.add(contacts.point_a.tobytes() + contacts.gap.tobytes())
        assert len(bits) == 1, count


@pytest.mark.parametrize("gap", [0, 1e-7])
def test_what_presses_on_an_area_forms_bonds_as_an_impulse_of_the_contact_does(gap):
    """Steps of contacts that touch, or, with a gap, come into touch only because something presses. A
    bond goes to the pressure over that of saturation, exponentially."""
    glue = dict(GLUE, bonding_rate=0.01, saturation_pressure=1e3, initial_intensity=0.1)
    pressed, carried, none = (tetwarp.ContactTracker([glue]) for _ in range(3))
    normal = 2e-4 * np.arange(1, 4)
    goal = normal / (DT * 1e-4) / 1e3  # 0.2, 0.4, 0.6
    impulse, intensities = np.outer(normal, (1, 0, 0)), []
    for _ in range(5):
        for tracker in (pressed, carried, none):
            tracker.begin_step(found(0, 1, 2, gap=gap), (REST, REST), DT)
        own = carried.end_step(impulse, (REST, REST))
        others = pressed.end_step(0 * impulse, (REST, REST), pressing=normal)
        assert np.array_equal(others.intensity, own.intensity)
        without = none.end_step(0 * impulse, (REST, REST))
        intensities.append(others.intensity)

    way = goal - np.array(intensities[1:])
    assert np.allclose(way[1:], way[:-1] * np.exp(-0.01 * 1e3 * DT), rtol=1e-9)
    assert (intensities[-1] > 0.1).all() and (without.intensity <= 0.1).all()
    with pytest.raises(ValueError, match=r"pressing: expected numbers of shape \(3,\)"):
        none.begin_step(found(0, 1, 2), (REST, REST), DT)
        none.end_step(impulse, (REST, REST), pressing=[1.0])
    with pytest.raises(ValueError, match="pressing"):
        none.end_step(impulse, (REST, REST), pressing=[1, np.nan, 1])


def test_a_step_that_has_not_begun_does_not_end():
    for impulse in (np.zeros((1, 3)), [(0, 0, 0)], 0, None, []):
        with pytest.raises((RuntimeError, ValueError), match="end_step|impulse"):
            tetwarp.ContactTracker().end_step(impulse, [])
