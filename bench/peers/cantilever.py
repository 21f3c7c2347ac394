"""The cantilever that the cantilever_*.py programs solve, and its exact deflection.

1 x 0.1 x 0.1 m, clamped at x = 0, E = 1e6 Pa, density 1000 kg/m^3. Gravity is 0.0981 m/s^2, so that
the tip sinks by 15 mm and linear beam theory holds. Damping is 6 1/s times the mass, nearly critical.
"""

LENGTH, WIDTH = 1.0, 0.1
YOUNG, DENSITY, GRAVITY = 1e6, 1000.0, 0.0981
DAMPING = 6.0
DURATION = 5.0


def timoshenko(nu):
    """Deflection [m] of the tip under its own weight, shear coefficient by Cowper."""
    load = DENSITY * GRAVITY * WIDTH**2
    shear = YOUNG / (2 * (1 + nu)) * WIDTH**2 * 10 * (1 + nu) / (12 + 11 * nu)
    bending = YOUNG * WIDTH**4 / 12
    return load * LENGTH**4 / (8 * bending) + load * LENGTH**2 / (2 * shear)


def rest_time(times, tips):
    """First time [s] from which the tip stays within 1 % of its last deflection."""
    late = [t for t, tip in zip(times, tips) if abs(tip - tips[-1]) > 0.01 * abs(tips[-1])]
    return max(late, default=0.0)


def report(peer, nu, cells, step, milliseconds, times, tips):
    print(f"{peer} nu={nu} cells={cells} dt={step:g} s: {milliseconds:.3f} ms per step, "
          f"tip/Timoshenko {tips[-1] / timoshenko(nu):.4f}, rest after {rest_time(times, tips):.2f} s",
          flush=True)
