"""Files and figures for the test `eval_attitude`: a simulated hand, an estimate of its attitude, and what an independent
scorer says of them.

    make_numbers.py score_attitude.py        the scorer of the acceptance (numpy); writes beside this file

estimate.tum  attitude at 100 Hz, all positions zero, scalar last
truth.csv     true attitude at 50 Hz, scalar first, to 16 digits; some rows empty, `moving` marks the middle
score.json    what the scorer prints for the two
"""
import importlib.util
import json
import pathlib
import sys

import numpy as np

here = pathlib.Path(__file__).parent


def turn(vector):
    angle = np.linalg.norm(vector)
    return np.r_[np.cos(angle / 2), np.asarray(vector) * (np.sin(angle / 2) / angle)]


def product(a, b):
    (w, x, y, z), (s, i, j, k) = a, b
    return np.array([w * s - x * i - y * j - z * k, w * i + x * s + y * k - z * j, w * j - x * k + y * s + z * i, w * k + x * j - y * i + z * s])


def true_attitude(t):
    return product(turn([0.01, 0.01, 1.9 * np.sin(0.7 * t) + 0.4 * t]), turn([0.8 * np.sin(1.1 * t), 0.5 * np.cos(0.9 * t) + 0.01, 0.001]))


def error(t):
    # Degrees up to some tens, so that no part hides another.
    return turn([0.02 * np.sin(2.3 * t), 0.03 * np.cos(1.7 * t), -0.04 - 0.02 * t + 0.3 * np.exp(-t)])


def main(scorer):
    with open(here / "estimate.tum", "w") as out:
        out.write("# time_s x_m y_m z_m qx qy qz qw\n")
        for k in range(801):
            w, x, y, z = product(error(k / 100), true_attitude(k / 100)) * (1 if k % 3 else -1)
            out.write(f"{k / 100:.2f} 0 0 0 {x:.16g} {y:.16g} {z:.16g} {w:.16g}\n")
    with open(here / "truth.csv", "w") as out:
        out.write("time_s,qw,qx,qy,qz,moving\n")
        for k in range(401):
            moving = int(75 <= k < 190 or 230 <= k < 330)
            q = ",".join(f"{v:.16g}" for v in true_attitude(k / 50))
            out.write(f"{k / 50:.2f},{',,,' if 100 <= k < 112 else q},{moving}\n")
    spec = importlib.util.spec_from_file_location("scorer", scorer)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    (here / "score.json").write_text(json.dumps(module.score(here / "estimate.tum", here / "truth.csv"), indent=1) + "\n")


main(sys.argv[1])
