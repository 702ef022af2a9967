"""Places by ranges, minimised by scipy, for tests/ranging.rs. Writes ranging.csv beside it.

Linear: numpy.linalg.lstsq on the rows of Jia et al. 2024, eq. 3, in space. Robust: sum (nu+1)/2 ln(1 + e^2/nu) + (z-m)^2 / 2 s^2, the least of
scipy.optimize.minimize (BFGS, then Nelder-Mead to 1e-10) begun at 27 places; covariance: inverse of the expected information
H'H / f + the height's, f = min(K^2 (nu+3)/(nu+1), nu/(nu-2)), K = 1 + p/n Var psi' / (E psi')^2 (Huber 1981, 7.6), the expectations by scipy's quadrature over
Student's t, p the trace of the ranges' share of the information.
Columns: problem; for each of 6 anchors x, y, z, range; height mean, sd; linear x, y, z; robust x, y, z; covariance xx, xy, xz, yy, yz, zz; HDOP, VDOP at
the robust place.
"""
import csv
import itertools
import pathlib

import numpy as np
from scipy.integrate import quad
from scipy.optimize import minimize
from scipy.stats import t

rng = np.random.default_rng(20261122)
NU, SIGMA = 4.0, 0.15
rows = []


def slope(e):
    return (NU + 1) * (NU - e * e) / (NU + e * e) ** 2


MANY = quad(lambda e: slope(e) * t.pdf(e, NU), -np.inf, np.inf)[0]
SPREAD = quad(lambda e: slope(e) ** 2 * t.pdf(e, NU), -np.inf, np.inf)[0] / MANY**2 - 1
for problem in range(40):
    truth = np.r_[rng.uniform(2, 28, 2), rng.uniform(0.8, 1.6)]
    anchor = np.c_[rng.uniform(0, 30, (6, 2)), rng.uniform(1.5, 6, 6)]
    ranges = np.linalg.norm(truth - anchor, axis=1) + rng.normal(0, SIGMA, 6)
    if problem % 3 == 0:
        ranges[rng.integers(6)] += rng.uniform(1, 4)
    mean, sd = 1.2, 0.3

    a = 2 * (anchor[:-1] - anchor[-1])
    r2 = ranges**2 - (anchor**2).sum(1)
    linear = np.linalg.lstsq(a, r2[-1] - r2[:-1], rcond=None)[0]

    def cost(p):
        e = (np.linalg.norm(p - anchor, axis=1) - ranges) / SIGMA
        return (0.5 * (NU + 1) * np.log1p(e * e / NU)).sum() + 0.5 * ((p[2] - mean) / sd) ** 2

    starts = [np.r_[x, y, z] for x, y, z in itertools.product((3, 15, 27), (3, 15, 27), (0, 1.2, 4))]
    best = min((minimize(cost, s) for s in starts), key=lambda r: r.fun)
    best = minimize(cost, best.x, method="Nelder-Mead", options=dict(xatol=1e-10, fatol=1e-14, maxiter=20000, maxfev=20000))
    u = best.x - anchor
    u /= np.linalg.norm(u, axis=1)[:, None]
    plain = u.T @ u / SIGMA**2
    height = np.diag([0, 0, 1 / sd**2])
    p = np.trace(plain * MANY @ np.linalg.inv(plain * MANY + height))
    f = min((1 + p / 6 * SPREAD) ** 2 / MANY, NU / (NU - 2))
    c = np.linalg.inv(plain / f + height)
    q = np.linalg.inv(u.T @ u)
    rows.append([problem, *np.c_[anchor, ranges].ravel(), mean, sd, *linear, *best.x,
                 c[0, 0], c[0, 1], c[0, 2], c[1, 1], c[1, 2], c[2, 2], np.sqrt(q[0, 0] + q[1, 1]), np.sqrt(q[2, 2])])
with open(pathlib.Path(__file__).with_suffix(".csv"), "w", newline="") as f:
    csv.writer(f).writerows([[f"{v:.12g}" for v in row] for row in rows])
