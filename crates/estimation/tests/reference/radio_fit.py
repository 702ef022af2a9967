"""Positions by signal strengths, minimised by scipy, for tests/radio_fit.rs. Writes radio_fit.csv beside it.

Cost: sum (nu+1)/2 ln(1 + e^2/nu) + c^2 / 2 s^2 + (p-m)' S^-1 (p-m) / 2, the minimum next to the truth by Nelder-Mead to 1e-9.
Columns: problem, truth x, y, then for each of 6 transmitters x, y, z, A, n, RSSI; then prior mean x, y, its sd, and the minimum x, y.
"""
import csv
import pathlib

import numpy as np
from scipy.optimize import minimize

rng = np.random.default_rng(20261122)
NU, OFFSET, SIGMA, HEIGHT = 4.0, 3.0, 4.0, 1.2
rows = []
for problem in range(40):
    truth = rng.uniform(5, 35, 2)
    ap = np.c_[rng.uniform(0, 40, (6, 2)), rng.uniform(2, 4, 6), rng.uniform(-50, -35, 6), rng.uniform(1.6, 3.5, 6)]

    def mean(p):
        d = np.sqrt(((p - ap[:, :2]) ** 2).sum(1) + (ap[:, 2] - HEIGHT) ** 2)
        return ap[:, 3] - 10 * ap[:, 4] * np.log10(np.maximum(d, 0.3))

    rssi = mean(truth) + rng.normal(0, 2) + rng.normal(0, 2, 6)
    centre, spread = truth + rng.normal(0, 5, 2), 10.0

    def cost(q):
        e = (mean(q[:2]) + q[2] - rssi) / SIGMA
        return (0.5 * (NU + 1) * np.log1p(e * e / NU)).sum() + 0.5 * (q[2] / OFFSET) ** 2 + 0.5 * ((q[:2] - centre) ** 2).sum() / spread**2

    # The global minimum: begun all over the place.
    best = min(
        (minimize(cost, [x, y, 0.0], method="Nelder-Mead", options=dict(xatol=1e-9, fatol=1e-12, maxiter=20000, maxfev=20000))
         for x in np.arange(0, 41, 10) for y in np.arange(0, 41, 10)),
        key=lambda r: r.fun,
    )
    rows.append([problem, *truth, *np.c_[ap, rssi].ravel(), *centre, spread, *best.x[:2], best.fun])
with open(pathlib.Path(__file__).with_suffix(".csv"), "w", newline="") as f:
    csv.writer(f).writerows([[f"{v:.10g}" for v in row] for row in rows])
