"""VQF by its authors (package vqf, C++ core) with its default settings on a log in adit's CSV.

    vqf_attitude.py LOG.csv[.gz] ONLINE.tum OFFLINE.tum     attitudes as TUM text, ENU, positions zero
    vqf_attitude.py LOG.csv[.gz]                            prints nine-axis samples per second of updateBatch, best of 20

With the columns of a magnetometer nine axes are used, else six.
"""
import gzip
import sys
import time

import numpy as np
from vqf import VQF, offlineVQF


def read(path):
    opened = gzip.open if path.endswith(".gz") else open
    with opened(path, "rt") as log:
        names = log.readline().strip().split(",")
        rows = np.loadtxt(log, delimiter=",")
    axes = lambda sensor, unit: [names.index(f"{sensor}_{axis}_{unit}") for axis in "xyz"]
    take = lambda columns: np.ascontiguousarray(rows[:, columns])
    field = take(axes("mag", "uT")) if "mag_x_uT" in names else None
    return rows[:, names.index("time_s")], take(axes("gyro", "rad_s")), take(axes("acc", "m_s2")), field


def write(path, times, quaternions):
    q = quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)
    rows = np.c_[times, np.zeros((len(q), 3)), q[:, [1, 2, 3, 0]]]
    np.savetxt(path, rows, fmt=["%.9f", "%d", "%d", "%d"] + ["%.12g"] * 4)


def main(log, *out):
    times, gyro, acc, field = read(log)
    interval = (times[-1] - times[0]) / (len(times) - 1)
    if not out:
        best = np.inf
        for _ in range(20):
            vqf = VQF(interval)
            start = time.perf_counter()
            vqf.updateBatch(gyro, acc, field)
            best = min(best, time.perf_counter() - start)
        print(f"{len(times) / best:.0f}")
        return
    quaternion = "quat6D" if field is None else "quat9D"
    online, offline = out
    write(online, times, VQF(interval).updateBatch(gyro, acc, field)[quaternion])
    write(offline, times, offlineVQF(gyro, acc, field, interval)[quaternion])


main(*sys.argv[1:])
