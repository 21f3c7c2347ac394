#!/usr/bin/env python3
"""Time Siconos' nonsmooth Gauss-Seidel (NSGS) on recorded contact problems without adhesion.

Problems in global form are reduced to W = H^T A^-1 H first, which is not timed; NSGS gets W in
sparse 3x3 blocks, its fastest storage. Prints a line per file and tolerance, which `bench/report`
reads with --peers: contacts, sweeps, Siconos' own error, FCLIB's error of the result, seconds.
Needs python3-siconos, python3-h5py and python3-scipy.
"""
import argparse
import os
import tempfile
import time

import h5py
import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg


def read_matrix(group):
    """An FCLIB matrix: nz is -1 for compressed columns, -2 for compressed rows, else a count."""
    scalar = lambda name: int(np.ravel(group[name][()])[0])
    x, p, i, nz = group["x"][()], group["p"][()], group["i"][()], scalar("nz")
    shape = scalar("m"), scalar("n")
    if nz == -1:
        return sparse.csc_matrix((x, i, p), shape=shape).tocsr()
    if nz == -2:
        return sparse.csr_matrix((x, i, p), shape=shape)
    return sparse.coo_matrix((x[:nz], (i[:nz], p[:nz])), shape=shape).tocsr()


def read_local(path):
    """(W, q, mu) of a problem: velocity u = W r + q, friction mu per contact."""
    with h5py.File(path, "r") as file:
        if "fclib_local" in file:
            group = file["fclib_local"]
            w, q = read_matrix(group["W"]), group["vectors/q"][()]
            return w, q, group["vectors/mu"][()]
        group = file["fclib_global"]
        mass, jacobian = read_matrix(group["M"]), read_matrix(group["H"])
        force, offset = group["vectors/f"][()], group["vectors/w"][()]
        friction = group["vectors/mu"][()]
    if jacobian.shape[0] != mass.shape[0]:
        jacobian = jacobian.T.tocsr()
    factor = linalg.splu(mass.tocsc())
    w = sparse.csr_matrix(jacobian.T @ factor.solve(jacobian.toarray()))
    return w, jacobian.T @ factor.solve(force) + offset, friction


def write_blocks(file, w, q, friction):
    """Siconos' text format: dimension, contacts, storage 1, the block matrix, q, friction."""
    blocks = sparse.bsr_matrix(w, blocksize=(3, 3))
    blocks.sort_indices()
    contacts, count = len(friction), len(blocks.indices)
    ends = " ".join(str(3 * (c + 1)) for c in range(contacts))
    numbers = lambda values: "\n".join(f"{x:.17e}" for x in values) + "\n"
    file.write(f"3\n{contacts}\n1\n{3 * contacts}\n{3 * contacts}\n{count}\n")
    file.write(f"{contacts}\n{contacts}\n{ends}\n{ends}\n{contacts + 1}\n{count}\n")
    file.write(" ".join(map(str, blocks.indptr)) + "\n")
    file.write(" ".join(map(str, blocks.indices)) + "\n")
    for at in range(count):
        file.write(f"{at}\n" + numbers(blocks.data[at].ravel(order="F")))
    file.write(numbers(q) + numbers(friction))


def fclib_error(q, friction, impulse, velocity):
    """|r - P_K(r - (u + mu |u_t| n))| / |q|, P_K the projection onto the friction cones."""
    r, u = impulse.reshape(-1, 3), velocity.reshape(-1, 3).copy()
    u[:, 0] += friction * np.linalg.norm(u[:, 1:], axis=1)
    z = r - u
    normal, tangent = z[:, 0], np.linalg.norm(z[:, 1:], axis=1)
    inside, polar = tangent <= friction * normal, friction * tangent <= -normal
    s = (friction * tangent + normal) / (1 + friction * friction)
    projected = np.zeros_like(z)
    projected[:, 0] = np.where(inside, normal, np.where(polar, 0, s))
    shrink = np.where(polar, 0, friction * s / np.maximum(tangent, 1e-300))
    projected[:, 1:] = z[:, 1:] * np.where(inside, 1, shrink)[:, None]
    return np.linalg.norm(r - projected) / max(np.linalg.norm(q), 1e-300)


def solve(problem_file, size, tolerance, max_sweeps, solver="NSGS"):
    """(converged, sweeps, Siconos' error, impulses, seconds) of one solve.

    solver: the end of the name of Siconos' constant SICONOS_FRICTION_3D_...
    """
    import siconos.numerics as numerics

    problem = numerics.frictionContactProblemFromFile(problem_file)
    options = numerics.SolverOptions(getattr(numerics, "SICONOS_FRICTION_3D_" + solver))
    options.dparam[numerics.SICONOS_DPARAM_TOL] = tolerance
    options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = max_sweeps
    impulse, velocity = np.zeros(size), np.zeros(size)
    start = time.perf_counter()
    status = numerics.fc3d_driver(problem, impulse, velocity, options)
    seconds = time.perf_counter() - start
    sweeps = options.iparam[numerics.SICONOS_IPARAM_ITER_DONE]
    return status == 0, sweeps, options.dparam[numerics.SICONOS_DPARAM_RESIDU], impulse, seconds


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("files", nargs="+", metavar="FILE.hdf5")
    parser.add_argument("--tolerance", type=float, nargs="*", default=[1e-4, 1e-8])
    parser.add_argument("--max-sweeps", type=int, default=20000)
    arguments = parser.parse_args()
    for path in arguments.files:
        w, q, friction = read_local(path)
        with tempfile.NamedTemporaryFile("w", suffix=".dat") as file:
            write_blocks(file, w, q, friction)
            file.flush()
            for tolerance in arguments.tolerance:
                converged, sweeps, own_error, impulse, seconds = solve(
                    file.name, len(q), tolerance, arguments.max_sweeps
                )
                error = fclib_error(q, friction, impulse, w @ impulse + q)
                print(
                    f"{os.path.basename(path):44s} contacts {len(friction):5d} "
                    f"tol {tolerance:.0e} {'ok  ' if converged else 'FAIL'} sweeps {sweeps:6d} "
                    f"siconos {own_error:.1e} fclib {error:.1e} {seconds:8.4f} s",
                    flush=True,
                )


if __name__ == "__main__":
    main()
