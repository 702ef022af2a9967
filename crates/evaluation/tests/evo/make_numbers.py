#!/usr/bin/env python3
"""Makes the files that `tests/evo.rs` reads: two synthetic TUM files and the numbers evo and numpy draw from them.

    pip install evo==1.38.1 numpy
    python make_numbers.py [--score /path/to/score.py]

estimate.tum, truth.tum   a walk of 20 s up a winding ramp; the estimate at another rate, with jitter, drift and noise
evo.json                  APE and RPE by evo (Grupp), association by nearest stamps within 10 ms
score.json                the same files under the alignments none, start, se2 and se3, estimate interpolated at the truth,
                          by score.py, adit's acceptance script (numpy only, kept apart from adit); left as it is without --score
"""
import argparse, json, pathlib, subprocess, sys
import numpy as np
from evo.core import metrics, sync
from evo.core.metrics import PoseRelation, Unit
from evo.tools import file_interface

HERE = pathlib.Path(__file__).parent


def multiply(a, b):
    """Hamilton product of scalar-first quaternions."""
    w, x, y, z = a; s, i, j, k = b
    return np.array([w*s - x*i - y*j - z*k, w*i + x*s + y*k - z*j, w*j - x*k + y*s + z*i, w*k + x*j - y*i + z*s])


def quaternion(rotation_vector):
    angle = np.linalg.norm(rotation_vector)
    if angle == 0.0:
        return np.array([1.0, 0, 0, 0])
    return np.r_[np.cos(angle / 2), np.sin(angle / 2) * rotation_vector / angle]


def pose(t):
    position = np.array([430.0 + 6 * np.sin(0.31 * t), 120.0 + 4 * np.sin(0.57 * t + 0.4), -35.0 + 0.06 * t + 0.1 * np.sin(2 * t)])
    heading = multiply(quaternion(np.array([0, 0, 0.8 * np.sin(0.31 * t) + 0.2 * t])), quaternion(np.array([0.2 * np.sin(1.3 * t), 0.15 * np.cos(0.9 * t), 0])))
    return position, heading


def write(name, stamps, poses):
    with open(HERE / name, "w") as file:
        print("# t x y z qx qy qz qw", file=file)
        for t, (p, q) in zip(stamps, poses):
            print(f"{t:.9f} " + " ".join(f"{v:.9f}" for v in (*p, *q[1:], q[0])), file=file)


def make_files():
    draw = np.random.RandomState(20240607)
    stamps = np.arange(200) * 0.1 + 0.013
    write("truth.tum", stamps, [pose(t) for t in stamps])
    # Twice the rate, jittered by at most 8 ms, starting and ending outside the truth's span; another frame, turned and moved.
    stamps = np.sort(np.arange(405) * 0.05 - 0.083 + draw.uniform(-0.008, 0.008, 405))
    turn = quaternion(np.array([0.05, -0.08, 1.1]))
    poses, drift, wander = [], np.zeros(3), np.zeros(3)
    for t in stamps:
        p, q = pose(t)
        drift += draw.normal(0, 0.006, 3) + [0.0012, -0.0004, 0.0003]; wander += draw.normal(0, 0.002, 3)
        p = multiply(multiply(turn, np.r_[0.0, p - [430, 120, -35]]), turn * [1, -1, -1, -1])[1:] + drift + draw.normal(0, 0.01, 3)
        q = multiply(multiply(turn, quaternion(wander + draw.normal(0, 0.005, 3))), q)
        poses.append((p + [3.0, -2.0, 0.5], q))
    write("estimate.tum", stamps, poses)


def statistics(metric, pair):
    metric.process_data(pair)
    return {"pairs": len(metric.error), **{name: float(value) for name, value in metric.get_all_statistics().items()}}


def evo_numbers():
    truth, estimate = (file_interface.read_tum_trajectory_file(str(HERE / name)) for name in ("truth.tum", "estimate.tum"))
    truth, estimate = sync.associate_trajectories(truth, estimate, max_diff=0.01)
    numbers = {"associated": truth.num_poses, "path_sum_truth_m": float(truth.path_length), "path_sum_estimate_m": float(estimate.path_length)}
    for alignment in ("none", "se3"):
        if alignment == "se3":
            estimate.align(truth)
        numbers[f"ape_{alignment}"] = {
            "translation_m": statistics(metrics.APE(PoseRelation.translation_part), (truth, estimate)),
            "angle_deg": statistics(metrics.APE(PoseRelation.rotation_angle_deg), (truth, estimate)),
        }
    for name, delta, unit, all_pairs in (("1_frame", 1, Unit.frames, False), ("10_frames", 10, Unit.frames, False), ("1_m", 1.0, Unit.meters, False),
                                         ("10_frames_all", 10, Unit.frames, True), ("2_m_all", 2.0, Unit.meters, True)):
        numbers[f"rpe_{name}"] = {
            key: statistics(metrics.RPE(relation, delta, unit, 0.1, all_pairs), (truth, estimate))
            for key, relation in (("translation_m", PoseRelation.translation_part), ("angle_deg", PoseRelation.rotation_angle_deg))
        }
    return numbers


def score_numbers(script):
    runs = {"none": [], "start": [], "start_3_m": ["--start-distance", "3"], "se2": [], "se3": []}
    numbers = {}
    for name, more in runs.items():
        command = [sys.executable, script, HERE / "estimate.tum", HERE / "truth.tum", "--align", name.split("_")[0], *more]
        numbers[name] = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        del numbers[name]["est"]
    return numbers


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--score")
    arguments = parser.parse_args()
    make_files()
    (HERE / "evo.json").write_text(json.dumps(evo_numbers(), indent=1) + "\n")
    if arguments.score:
        (HERE / "score.json").write_text(json.dumps(score_numbers(arguments.score), indent=1) + "\n")
