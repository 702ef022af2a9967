"""Exact 95 % radius of a bivariate Gaussian against the ratio of its axes, to radius_95.csv.

P(|x| < R) in polar coordinates leaves one integral over the angle, which scipy takes; brentq solves P(R) = 0.95.
Made with Python 3, numpy, scipy 1.17:   python radius_95.py > radius_95.csv
"""

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import erf


def probability(radius, ratio):
    """Share of a Gaussian with standard deviations 1 and `ratio` inside `radius`."""
    if ratio == 0.0:
        return erf(radius / np.sqrt(2.0))

    def ring(angle):
        inverse_variance = np.cos(angle) ** 2 + (np.sin(angle) / ratio) ** 2
        return -np.expm1(-0.5 * radius**2 * inverse_variance) / inverse_variance

    breaks = [min(ratio, 1.5), min(5.0 * ratio, 1.55)]
    integral = quad(ring, 0.0, np.pi / 2, points=breaks, epsabs=1e-14, epsrel=1e-13, limit=500)[0]
    return 2.0 / (np.pi * ratio) * integral


print("axis_ratio,radius_95_in_major_sigmas")
for ratio in np.linspace(0.0, 1.0, 101):
    radius = brentq(lambda r: probability(r, ratio) - 0.95, 1.9, 2.5, xtol=1e-13)
    print(f"{ratio:.2f},{radius:.10f}")
