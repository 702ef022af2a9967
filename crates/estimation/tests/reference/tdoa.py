"""Places by differences of arrival, minimised by scipy, for tests/ranging_tdoa.rs. Writes tdoa.csv beside it.

Plain: 1/2 r' Q^-1 r of the differences r with their full covariance Q = diag(s_i^2) + s_0^2, and the height's. Robust: of the arrivals, sum (nu+1)/2 ln(1 + e^2/nu)
with the common offset free, nu = 4. The least of scipy.optimize.minimize (BFGS, then Nelder-Mead to 1e-11) begun at 27 places. Covariance of the plain one:
inverse of G' Q^-1 G + the height's, G the gradients of the differences.
Columns: problem; for each of 6 anchors x, y, z, difference to the first, s; height mean, sd; plain x, y, z; its covariance xx, xy, xz, yy, yz, zz; robust x, y, z.
"""
import csv
import itertools
import pathlib

import numpy as np
from scipy.optimize import minimize

rng = np.random.default_rng(20261123)
NU = 4.0
rows = []


def least(cost, starts):
    best = min((minimize(cost, s) for s in starts), key=lambda r: r.fun)
    for _ in range(2):
        best = minimize(cost, best.x, method="Nelder-Mead", options=dict(xatol=1e-11, fatol=1e-15, maxiter=40000, maxfev=40000))
    return best.x


for problem in range(40):
    truth = np.r_[rng.uniform(5, 25, 2), rng.uniform(0.8, 1.6)]
    anchor = np.c_[rng.uniform(0, 30, (6, 2)), rng.uniform(1.5, 6, 6)]
    sigma = rng.uniform(0.05, 0.25, 6)
    arrival = np.linalg.norm(truth - anchor, axis=1) + rng.normal(0, sigma)
    if problem % 3 == 0:
        arrival[rng.integers(6)] += rng.uniform(1, 3)
    d = arrival - arrival[0]
    mean, sd = 1.2, 0.3
    q = np.linalg.inv(np.diag(sigma[1:] ** 2) + sigma[0] ** 2)

    def plain(p):
        r = np.linalg.norm(p - anchor, axis=1)
        e = (r - r[0] - d)[1:]
        return 0.5 * e @ q @ e + 0.5 * ((p[2] - mean) / sd) ** 2

    def robust(x):
        e = (np.linalg.norm(x[:3] - anchor, axis=1) + x[3] - d) / sigma
        return (0.5 * (NU + 1) * np.log1p(e * e / NU)).sum() + 0.5 * ((x[2] - mean) / sd) ** 2

    starts = [np.r_[x, y, z] for x, y, z in itertools.product((3, 15, 27), (3, 15, 27), (0, 1.2, 4))]
    p = least(plain, starts)
    u = (p - anchor) / np.linalg.norm(p - anchor, axis=1)[:, None]
    g = (u - u[0])[1:]
    info = g.T @ q @ g
    info[2, 2] += 1 / sd**2
    c = np.linalg.inv(info)
    with_offset = [np.r_[s, np.median(d - np.linalg.norm(s - anchor, axis=1))] for s in starts]
    t = least(robust, with_offset)
    rows.append([problem, *np.c_[anchor, d, sigma].ravel(), mean, sd, *p, c[0, 0], c[0, 1], c[0, 2], c[1, 1], c[1, 2], c[2, 2], *t[:3]])
with open(pathlib.Path(__file__).with_suffix(".csv"), "w", newline="") as f:
    csv.writer(f, lineterminator="\n").writerows([[f"{v:.12g}" for v in row] for row in rows])
