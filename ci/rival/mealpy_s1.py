"""What tuning system S1 costs with the tools of its field: mealpy's DevBA over a Kalman filter on numpy.

    mealpy_s1.py WALKS.csv EVALUATIONS   prints evaluations/s, the cost of the untuned filter and the least cost found, m2

WALKS.csv: `walk,time_s,pdr_x_m,pdr_y_m,fix_x_m,fix_y_m,true_x_m,true_y_m`, a line to a report. The filter is that of `adit_estimation::methods::pdr_wifi`
(its defaults, a start known to 1 m): four states, velocities by differences of reports, noise densities in time; the four factors on Q and the four on R are tuned
as logarithms, from a thousandth to a thousandfold. The cost is the sum of squared horizontal errors.
Written plainly, as one does in Python; the matrices of a filter depend on nothing but times, and who makes them once for all walks of one rhythm is faster.
"""
import csv
import sys
import time

import numpy as np
from mealpy import BA, FloatVar

AGENTS, DECADES = 30, 3.0
POSITION_WALK_M2_S, VELOCITY_WALK_M2_S3, FIX_SIGMA_M, VELOCITY_SIGMA_M_S, START_SIGMA_M = 0.005, 1e-4, 4.0, 0.1, 1.0
Q0 = np.array([POSITION_WALK_M2_S] * 2 + [VELOCITY_WALK_M2_S3] * 2)
P0 = np.diag([START_SIGMA_M**2] * 2 + [VELOCITY_SIGMA_M_S**2] * 2)
I4 = np.eye(4)


def read(path):
    """Of each walk: times, dead reckoning, fixes, truth."""
    walks = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            walks.setdefault(row.pop("walk"), []).append([float(value) for value in row.values()])
    walks = [np.array(rows) for rows in walks.values()]
    return [(rows[:, 0], rows[:, 1:3], rows[:, 3:5], rows[:, 5:7]) for rows in walks]


def squared_error(walks, exponents):
    q, r = Q0 * 10 ** exponents[:4], FIX_SIGMA_M**2 * 10 ** exponents[4:]
    total = 0.0
    for times, reckoned, fixes, truth in walks:
        x, P = np.zeros(4), P0
        offsets = reckoned - fixes
        for k, offset in enumerate(offsets):
            if k == 0:
                H, z, R = I4[:2], offset, np.diag(r[:2])
            else:
                dt = times[k] - times[k - 1]
                F = I4.copy()
                F[0, 2] = F[1, 3] = dt
                x, P = F @ x, F @ P @ F.T + np.diag(q * dt)
                H = I4
                z = np.concatenate([offset, (offset - offsets[k - 1]) / dt])
                R = np.diag(np.concatenate([r[:2], 2 * r[2:] / dt**2]))
            K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R)
            x, P = x + K @ (z - H @ x), (I4 - K @ H) @ P
            error = reckoned[k] - x[:2] - truth[k]
            total += error @ error
    return float(total)


walks = read(sys.argv[1])
budget, evaluations = int(sys.argv[2]), 0


def cost(exponents):
    global evaluations
    evaluations += 1
    return squared_error(walks, exponents)


model = BA.DevBA(epoch=max(1, budget // AGENTS - 1), pop_size=AGENTS)
bounds = FloatVar(lb=(-DECADES,) * 8, ub=(DECADES,) * 8)
begun = time.perf_counter()
model.solve({"bounds": bounds, "minmax": "min", "obj_func": cost, "log_to": None}, seed=1)
spent = time.perf_counter() - begun
print(f"{evaluations / spent:.1f} {squared_error(walks, np.zeros(8)):.6f} {model.g_best.target.fitness:.6f}")
