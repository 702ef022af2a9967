"""The filter on ranges with dense matrices of numpy, for tests/range_filter.rs. Writes range_filter.csv beside it.

Transitions by scipy.linalg.expm of the continuous model, noise by Van Loan (1978), Joseph's form of the update, curvature by a finite difference of the
gradient: nothing is shared with the closed forms of the crate.
Columns: kind (0 equal, 1 IGG-III); time; anchor; range; innovation, its variance, weight; place x, y, z; covariance xx, xy, xz, yy, yz, zz;
common offset, its standard deviation.
"""
import csv
import pathlib

import numpy as np
from scipy.linalg import expm

ANCHORS = np.array([(2.0, 0.2, 3.2), (18.0, 0.2, 2.0), (22.0, 15.8, 3.2), (6.0, 15.8, 2.0)])
SPEED, STEADY, HEIGHT, SIGMA_H, CLIMB = 1.2, 3.0, 1.1, 0.5, 0.4
SIGMA, PASSING, CORRELATION, ANCHOR, OFFSET_S, COMMON = 0.1, 0.08, 1.2, 0.05, 900.0, 0.3
FULL, NONE, BOUND = 1.5, 6.0, 8.0
N = 7 + 8


def model():
    a, q, mean = np.zeros((N, N)), np.zeros((N, N)), np.zeros(N)
    for k in (0, 1):
        a[k, 3 + k] = 1
        a[3 + k, 3 + k] = -1 / STEADY
        q[3 + k, 3 + k] = 2 * SPEED**2 / STEADY
    w = CLIMB / SIGMA_H
    a[2, 5] = 1
    a[5, 2], a[5, 5] = -w * w, -2 * w
    q[5, 5] = 4 * w * CLIMB**2
    mean[2] = HEIGHT
    for i in range(4):
        for at, sigma, time in ((7 + i, ANCHOR, OFFSET_S), (11 + i, PASSING, CORRELATION)):
            a[at, at] = -1 / time
            q[at, at] = 2 * sigma**2 / time
    return a, q, mean


def van_loan(a, q, dt):
    big = expm(np.block([[-a, q], [np.zeros((N, N)), a.T]]) * dt)
    phi = big[N:, N:].T
    return phi, phi @ big[:N, N:]


def distance(p, anchor):
    return np.linalg.norm(p - anchor)


def hessian(p, anchor, h=1e-4):
    grad = lambda x: (x - anchor) / distance(x, anchor)
    return np.array([(grad(p + h * e) - grad(p - h * e)) / (2 * h) for e in np.eye(3)])


def run(kind, rows, rng):
    a, q, mean = model()
    x = np.zeros(N)
    x[:3] = (5.0, 4.0, 1.3)
    p = np.diag([0.5**2, 0.5**2, 0.3**2, SPEED**2, SPEED**2, CLIMB**2, COMMON**2] + [ANCHOR**2] * 4 + [PASSING**2] * 4)
    now = 0.0
    for step in range(120):
        anchor = step % 4
        # Every tenth comes after the next, older than the state.
        time = round(0.1 * (step // 4 + 1) + 0.005 * anchor - (0.15 if step % 10 == 9 else 0.0), 6)
        truth = np.array([5 + 0.8 * time, 4 + 0.5 * np.sin(time), 1.2])
        r = distance(truth, ANCHORS[anchor]) + 0.2 + rng.normal(0, 0.05) + (1.5 if step % 17 == 5 else 0.0)
        if time > now:
            phi, noise = van_loan(a, q, time - now)
            x = mean + phi @ (x - mean)
            p = phi @ p @ phi.T + noise
            now = time
        age = max(now - time, 0.0)
        place = x[:3] - age * x[3:6]
        u = (place - ANCHORS[anchor]) / distance(place, ANCHORS[anchor])
        bent = hessian(place, ANCHORS[anchor]) @ p[:3, :3]
        h = np.zeros(N)
        h[:3], h[3:6] = u, -age * u
        h[[6, 7 + anchor, 11 + anchor]] = 1
        value = r - distance(place, ANCHORS[anchor]) - 0.5 * np.trace(bent) - x[[6, 7 + anchor, 11 + anchor]].sum()
        noise = SIGMA**2 - PASSING**2 + 0.5 * np.trace(bent @ bent)
        s = h @ p @ h + noise
        e = abs(value) / np.sqrt(s)
        weight = 1.0
        if kind == 1 and e > FULL:
            weight = FULL / e * ((NONE - e) / (NONE - FULL)) ** 2 if e < NONE else 0.0
        if e > BOUND:
            weight = 0.0
        if weight > 0:
            # The variance of the innovation becomes S / w: that of the range S / w - H P H'.
            own = s / weight - h @ p @ h
            gain = p @ h * weight / s
            x = x + gain * value
            left = np.eye(N) - np.outer(gain, h)
            p = left @ p @ left.T + np.outer(gain, gain) * own
        c = p[:3, :3]
        rows.append([kind, time, anchor, r, value, s, weight, *x[:3], c[0, 0], c[0, 1], c[0, 2], c[1, 1], c[1, 2], c[2, 2], x[6], np.sqrt(p[6, 6])])


rows = []
for kind in (0, 1):
    run(kind, rows, np.random.default_rng(20261122))
with open(pathlib.Path(__file__).with_suffix(".csv"), "w", newline="") as file:
    csv.writer(file, lineterminator="\n").writerows([[f"{v:.12g}" for v in row] for row in rows])
