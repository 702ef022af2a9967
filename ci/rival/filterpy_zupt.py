"""Fifteen-state zero-velocity filter on filterpy, the common Python Kalman library: samples per second.

    filterpy_zupt.py WALK.csv [SAMPLES]

The same work as adit's streaming method does on a sample: strapdown in the local level frame, prediction of the
covariance with its transition matrix, and, every second sample in stance, a zero-velocity update in Joseph form.
"""
import sys
import time

import numpy as np
from filterpy.kalman import KalmanFilter


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def main():
    rows = np.loadtxt(sys.argv[1], delimiter=",", skiprows=1)[: int(sys.argv[2]) if len(sys.argv) > 2 else 6000]
    kf = KalmanFilter(dim_x=15, dim_z=3)
    kf.P = np.eye(15) * 1e-4
    kf.R = np.eye(3) * 1e-4
    kf.H = np.zeros((3, 15))
    kf.H[:, 3:6] = np.eye(3)
    q = np.repeat([1e-8, 1e-6, 0, 1e-12, 1e-9], 3)
    kf.Q = np.diag(q)
    f = rows[:80, 4:7].mean(0)
    up = f / np.linalg.norm(f)
    forward = np.cross([0, 1, 0], up)
    forward /= np.linalg.norm(forward)
    rotation = np.array([forward, np.cross(up, forward), up])
    velocity, position, gravity = np.zeros(3), np.zeros(3), np.array([0, 0, 9.80665])
    gyro_bias, acc_bias = np.zeros(3), np.zeros(3)
    transition = np.eye(15)
    start, last, updates = time.perf_counter(), rows[0, 0] - 0.005, 0
    for k, row in enumerate(rows):
        dt, last = row[0] - last, row[0]
        angle = (row[1:4] - gyro_bias) * dt
        force = rotation @ (row[4:7] - acc_bias)
        before = velocity
        velocity = velocity + (force - gravity) * dt
        position = position + (before + velocity) * (0.5 * dt)
        n = np.linalg.norm(angle)
        s = skew(angle)
        turn = np.eye(3) + s * (np.sin(n) / n if n > 1e-12 else 1) + s @ s * ((1 - np.cos(n)) / n**2 if n > 1e-12 else 0.5)
        transition[0:3, 9:12] = -rotation * dt
        transition[3:6, 0:3] = -skew(force * dt)
        transition[3:6, 12:15] = -rotation * dt
        transition[6:9, 3:6] = np.eye(3) * dt
        rotation = rotation @ turn
        kf.predict(F=transition)
        if row[7] and k % 2 == 0:
            kf.x[:] = 0
            kf.update(-velocity)
            x = kf.x[:, 0]
            rotation = (np.eye(3) + skew(x[0:3])) @ rotation
            velocity, position = velocity + x[3:6], position + x[6:9]
            gyro_bias, acc_bias = gyro_bias + x[9:12], acc_bias + x[12:15]
            updates += 1
    elapsed = time.perf_counter() - start
    assert updates > 0 and np.isfinite(position).all()
    print(f"{len(rows) / elapsed:.0f}")


main()
