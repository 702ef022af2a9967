"""Gaussian process with a log-distance trend by the explicit-basis equations, for src/fingerprint/process.rs. Writes process.csv.

Rasmussen & Williams 2006, eq. 2.41 to 2.43: the coefficients of the trend are solved for, not put into the kernel as adit does.
Lines: `spot x y mean count`, `place x y mean sd` (sd of one reading), `likelihood shadowing length spot value` (up to a constant).
"""
import pathlib

import numpy as np

rng = np.random.default_rng(5)
SITE = np.array([12.0, 7.0, 2.5])
B, b = np.diag([15.0**2, 1.0**2]), np.array([-40.0, 2.5])
WITHIN = 1.7
X = rng.uniform(0, 30, (25, 2))
n = rng.integers(1, 30, 25)


def basis(P):
    d = np.sqrt(((P - SITE[:2]) ** 2).sum(1) + SITE[2] ** 2)
    return np.c_[np.ones(len(P)), -10 * np.log10(np.maximum(d, 1.0))]


def cov(P, Q, s, l):
    return s * s * np.exp(-np.sqrt(((P[:, None] - Q[None]) ** 2).sum(2)) / l)


y = basis(X) @ [-43, 2.9] + np.linalg.cholesky(cov(X, X, 5, 9) + 1e-9 * np.eye(25)) @ rng.normal(size=25) + rng.normal(0, 2, 25)


def solve(s, l, spot):
    Ky = cov(X, X, s, l) + np.diag(spot**2 + WITHIN / n)
    H, Ki = basis(X), np.linalg.inv(Ky)
    A = np.linalg.inv(B) + H.T @ Ki @ H
    beta = np.linalg.solve(A, H.T @ Ki @ y + np.linalg.solve(B, b))
    r = y - H @ b
    S = Ky + H @ B @ H.T
    sign, logdet = np.linalg.slogdet(S)
    return Ky, H, Ki, A, beta, -0.5 * r @ np.linalg.solve(S, r) - 0.5 * logdet


lines = [f"spot {x[0]:.12g} {x[1]:.12g} {v:.12g} {k}" for x, v, k in zip(X, y, n)]
s, l, spot = 5.0, 9.0, 2.0
Ky, H, Ki, A, beta, _ = solve(s, l, spot)
Q = rng.uniform(-5, 35, (15, 2))
k = cov(Q, X, s, l)
Hq = basis(Q)
R = Hq - k @ Ki @ H
mean = Hq @ beta + k @ Ki @ (y - H @ beta)
var = s * s - np.einsum("ij,jk,ik->i", k, Ki, k) + np.einsum("ij,jk,ik->i", R, np.linalg.inv(A), R) + spot**2 + WITHIN
lines += [f"place {p[0]:.12g} {p[1]:.12g} {m:.12g} {v ** 0.5:.12g}" for p, m, v in zip(Q, mean, var)]
for s, l, spot in [(5, 9, 2), (3, 9, 2), (5, 2, 2), (5, 9, 0.5), (8, 30, 4)]:
    lines.append(f"likelihood {s} {l} {spot} {solve(s, l, spot)[-1]:.12g}")
pathlib.Path(__file__).with_suffix(".csv").write_text("\n".join(lines) + "\n")
