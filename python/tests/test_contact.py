"""Contact problems in and out."""

import numpy as np
import pytest

import tetwarp

SYSTEM = np.diag([2.0, 2, 2, 1, 1, 1])
JACOBIAN = np.array([(1, 0, 0, -1, 0, 0), (0, 1, 0, 0, -1, 0), (0, 0, 1, 0, 0, -1)], float)
GLOBAL = dict(system=SYSTEM, jacobian=JACOBIAN, load=[-3, 1, 0, 0, 0, 0],
              velocity_offset=[0, 0, 0], friction=[0.4])


def test_a_solution_obeys_the_equations():
    solution = tetwarp.solve_contacts(**GLOBAL)

    assert solution.converged and solution.residual < 1e-6
    r, v = solution.impulse.ravel(), solution.body_velocity
    assert np.allclose(SYSTEM @ v, JACOBIAN.T @ r + GLOBAL["load"])
    assert np.allclose(JACOBIAN @ v, solution.velocity.ravel())
    assert r[0] > 0 and np.hypot(r[1], r[2]) <= 0.4 * r[0] + 1e-9
    assert "1 contacts, converged" in repr(solution)


def test_matrices_may_be_sparse_in_any_form():
    sparse = pytest.importorskip("scipy.sparse")
    expected = tetwarp.solve_contacts(**GLOBAL).impulse

    for make in (sparse.csr_array, sparse.csc_matrix, sparse.coo_array):
        problem = {**GLOBAL, "system": make(SYSTEM), "jacobian": make(JACOBIAN)}
        assert np.array_equal(tetwarp.solve_contacts(**problem).impulse, expected)
    rows = sparse.csr_array(JACOBIAN)
    parts = (rows.data, rows.indices, rows.indptr, rows.shape)
    problem = {**GLOBAL, "jacobian": parts}
    assert np.array_equal(tetwarp.solve_contacts(**problem).impulse, expected)


def test_a_tuple_of_four_is_a_sparse_matrix_where_it_can_be_nothing_else():
    from tetwarp._contact import csr_of

    def dense_of(value):
        csr = csr_of(value, "jacobian")
        rows = np.repeat(np.arange(csr.shape[0]), np.diff(csr.indptr))
        matrix = np.zeros(csr.shape)
        matrix[rows, csr.indices] = csr.data
        return matrix.tolist()

    both = ([5.0, 7], [0, 3], [0, 2], (1, 4))
    with pytest.raises(ValueError, match="jacobian: may be a sparse row of two entries or four rows"):
        csr_of(both, "jacobian")
    assert dense_of(tetwarp.Csr(*both)) == [[5, 0, 0, 7]]
    assert dense_of(np.array(both)) == [[5, 7], [0, 3], [0, 2], [1, 4]]
    assert dense_of(([5.0], [1], [0, 1], (1, 2))) == [[0, 5]]
    for rows in (((1, 0), (0, 1), (1, 1), (2, 3)), ((5, 7), (0, 1), (0, 2), (2, 2)),
                 ((5, 7), (0, 4), (0, 2), (1, 4)), ((5, 7), (0, 1), (0, 1), (1, 2)),
                 ((1, 0, 2), (0, 1, 2), (1, 1, 3), (2, 3, 4))):
        assert dense_of(rows) == np.array(rows).tolist()
        assert dense_of(tuple(map(np.array, rows))) == np.array(rows).tolist()


def test_matrices_of_files_go_to_scipy(tmp_path):
    pytest.importorskip("scipy.sparse")
    tetwarp.write(tmp_path / "a.h5", tetwarp.ContactProblem(**GLOBAL))

    problem = tetwarp.read(tmp_path / "a.h5")

    assert problem.contact_count == 1 and "global" in repr(problem)
    assert np.array_equal(problem.jacobian.tocsr().toarray(), JACOBIAN)
    assert np.array_equal(tetwarp.solve_contacts(problem).impulse,
                          tetwarp.solve_contacts(**GLOBAL).impulse)


def test_adhesion_holds_what_is_pulled():
    pulled = dict(delassus=np.eye(3), free_velocity=[0.01, 0, 0], friction=[0.5])
    adhesion = dict(time_step=0.01, area=[1.0], stiffness=[1e6], intensity=[1.0])

    assert tetwarp.solve_contacts(**pulled).impulse[0, 0] == 0
    assert tetwarp.solve_contacts(**pulled, adhesion=adhesion).impulse[0, 0] < 0


def test_a_joint_holds_with_either_sign():
    joint = np.array([(0, 1, 0, 0, 0, 0), (0, 0, 1, 0, 0, 0)], float)

    solution = tetwarp.solve_contacts(
        **GLOBAL, bilateral=dict(jacobian=joint, target=[0.25, 0], compliance=[0, 0.5]),
        tolerance=1e-10)

    assert solution.converged
    v, r, held = solution.body_velocity, solution.impulse.ravel(), solution.bilateral_impulse
    assert v[1] == pytest.approx(0.25)
    assert v[2] + 0.5 * held[1] == pytest.approx(0)
    assert np.allclose(SYSTEM @ v, JACOBIAN.T @ r + joint.T @ held + GLOBAL["load"])


def test_rolling_friction_stops_a_roll():
    """A ball of 1 kg on the floor, turning slowly; dofs: velocity, then angular velocity."""
    system = np.diag([1.0, 1, 1, 0.4, 0.4, 0.4])
    contact = dict(system=system, jacobian=np.eye(3, 6), load=[-1, 0, 0, 0, 0.004, 0],
                   velocity_offset=[0, 0, 0], friction=[0.0], block_start=[0, 6])
    turning = np.eye(3, 6, 3)

    free = tetwarp.solve_contacts(**contact)
    stopped = tetwarp.solve_contacts(**contact, rolling=dict(
        contact=[0], jacobian=turning, rolling=[0.1], torsion=[0.1]))

    assert free.body_velocity[4] == pytest.approx(0.01)
    assert stopped.body_velocity[4] == pytest.approx(0, abs=1e-6)
    assert stopped.rolling_impulse.shape == (1, 3)
    assert stopped.rolling_impulse[0, 1] == pytest.approx(-0.004, rel=1e-3)


def test_further_rows_are_written_and_read(tmp_path):
    rows = dict(jacobian=np.eye(1, 6), target=[0.5], group_start=[0, 1])
    rolling = dict(contact=[0], jacobian=np.eye(3, 6, 3), rolling=[0.1], torsion=[0.2])
    tetwarp.write(tmp_path / "a.h5", tetwarp.ContactProblem(**GLOBAL, bilateral=rows,
                                                            rolling=rolling))

    back = tetwarp.read(tmp_path / "a.h5")

    jacobian = back.bilateral["jacobian"]
    assert (jacobian.data.tolist(), jacobian.indices.tolist()) == ([1], [0])
    assert (jacobian.indptr.tolist(), jacobian.shape) == ([0, 1], (1, 6))
    assert back.bilateral["target"].tolist() == [0.5]
    assert back.rolling["torsion"].tolist() == [0.2]


def test_wrong_rows_are_named():
    rows = dict(jacobian=np.eye(1, 6), target=[0.5])
    with pytest.raises(ValueError, match="bilateral: 'goal' is not one of jacobian, target"):
        tetwarp.ContactProblem(**GLOBAL, bilateral=dict(rows, goal=[1]))
    with pytest.raises(ValueError, match="rolling: expected a dict with jacobian"):
        tetwarp.ContactProblem(**GLOBAL, rolling=dict(contact=[0]))
    with pytest.raises(ValueError, match="bilateral.compliance"):
        tetwarp.solve_contacts(**GLOBAL, bilateral=dict(rows, compliance=[-1]))
    with pytest.raises(ValueError, match="bilateral.group_start: expected integers, got float64"):
        tetwarp.ContactProblem(**GLOBAL, bilateral=dict(rows, group_start=[0, 1.5]))
    with pytest.raises(ValueError, match="rolling.contact: expected numbers up to 2147483647"):
        tetwarp.ContactProblem(**GLOBAL, rolling=dict(jacobian=np.eye(3, 6), contact=[2**40]))


def test_a_solver_solves_a_series():
    solver = tetwarp.ContactSolver(tolerance=1e-9)
    for push in (1.0, 2.0, 4.0):
        problem = tetwarp.ContactProblem(delassus=np.eye(3), free_velocity=[-push, 0, 0],
                                         friction=[0.5])
        assert solver.solve(problem).impulse[0, 0] == pytest.approx(push)


def test_a_callback_ends_a_solve_and_its_errors_arrive():
    def fail(seconds, sweeps):
        raise ZeroDivisionError("mine")

    random = np.random.default_rng(2)
    factor = random.random((90, 90))
    problem = tetwarp.ContactProblem(delassus=factor @ factor.T + 0.01 * np.eye(90),
                                     free_velocity=-random.random(90), friction=np.full(30, 0.9))
    ended = tetwarp.solve_contacts(problem, progress=lambda *_: False, tolerance=1e-14)
    assert not ended.converged
    with pytest.raises(ZeroDivisionError, match="mine"):
        tetwarp.solve_contacts(problem, progress=fail, tolerance=1e-14)


@pytest.mark.parametrize("change, text", [
    (dict(friction=[-1]), "friction"),
    (dict(load=[1, 2]), "load"),
    (dict(system=np.zeros((2, 2, 2))), "system: expected a sparse matrix"),
    (dict(jacobian=([1.0], [0, 1], [0, 1], (1, 1))), "jacobian.indices: expected 1, got 2"),
    (dict(jacobian=([1.0], [0], [0, 1], (3, 6))), "jacobian.indptr: expected 4, got 2"),
    (dict(adhesion=dict(time_step=1, stifness=[1])), "adhesion: 'stifness' is not one of time_step"),
    (dict(adhesion=dict(area=[1])), "adhesion: expected a dict with time_step"),
    (dict(law="square"), "law: 'square' is not one of cone, pyramid"),
    (dict(tolerance=-1), "tolerance"),
])
def test_errors_name_the_member(change, text):
    with pytest.raises(ValueError, match=text):
        tetwarp.solve_contacts(**{**GLOBAL, **change})
