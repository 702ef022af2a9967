"""Overlapping Allan deviation by other people's code, to allan.csv.

The record is the 1000-point test suite of NIST SP 1065 (Riley 2008, section 12.4): a portable generator, whose deviations
are printed there for averaging factors 1, 10 and 100 (table 31); they are checked before anything is written. A random walk of
the same numbers follows.
Made with Python 3, numpy, allantools 2024.6:   python allan.py > allan.csv
"""

import allantools
import numpy as np

INTERVAL_S = 0.01
PRINTED = {1: 2.922319e-01, 10: 9.159953e-02, 100: 3.241343e-02}

n, white = 1234567890, []
for _ in range(1000):
    white.append(n / 2147483647)
    n = 16807 * n % 2147483647
walk = np.cumsum(np.array(white) - 0.5)


def deviations(readings, interval_s, factors):
    taus = np.array(factors) * interval_s
    found, values, _, _ = allantools.oadev(np.array(readings), rate=1 / interval_s, data_type="freq", taus=taus)
    assert np.allclose(found, taus)
    return values


for factor, printed in PRINTED.items():
    assert abs(deviations(white, 1.0, [factor])[0] - printed) < 5e-8 * 10, factor

factors = sorted({round(2 ** (i / 4)) for i in range(31)})
print("record,samples,deviation")
for name, readings in (("white", white), ("walk", walk)):
    for factor, value in zip(factors, deviations(readings, INTERVAL_S, factors)):
        print(f"{name},{factor},{value:.12e}")
