"""DevBA and OriginalSCA of mealpy on the sphere, Rastrigin's and Rosenbrock's function, 8 dimensions, 30 agents x 200 generations.

    mealpy_optimisers.py SEEDS >crates/tuning/tests/reference/mealpy.csv   lines `function,optimum,optimiser,evaluations,seed,cost`

Mean, median and the time of an evaluation go to standard error. mealpy evaluates its first places and 200 generations: 6030 evaluations of OriginalSCA, a
few more of DevBA. The optimum stands at the origin and, since sine cosine algorithms are drawn to zero, once more 30 % of the half width away from it.
Made with Python 3.11, mealpy 3.0.3.
"""
import sys
import time

import numpy as np
from mealpy import BA, SCA, FloatVar

DIMENSIONS, AGENTS, GENERATIONS = 8, 30, 200


def sphere(x):
    return float(np.sum(x * x))


def rastrigin(x):
    return float(10 * len(x) + np.sum(x * x - 10 * np.cos(2 * np.pi * x)))


def rosenbrock(x):
    return float(np.sum(100 * (x[1:] - x[:-1] ** 2) ** 2 + (1 - x[:-1]) ** 2))


def search(optimiser, function, half, shift, seed):
    """Evaluations and the least cost of one run."""
    evaluations = 0

    def cost(x):
        nonlocal evaluations
        evaluations += 1
        return function(x - shift)

    model = optimiser(epoch=GENERATIONS, pop_size=AGENTS)
    bounds = FloatVar(lb=(-half,) * DIMENSIONS, ub=(half,) * DIMENSIONS)
    model.solve({"bounds": bounds, "minmax": "min", "obj_func": cost, "log_to": None}, seed=seed)
    return evaluations, model.g_best.target.fitness


print("function,optimum,optimiser,evaluations,seed,cost")
for name, function, half, place, shift in (
    ("sphere", sphere, 10.0, "origin", 0.0),
    ("sphere", sphere, 10.0, "shifted", 0.3 * 10.0),
    ("rastrigin", rastrigin, 5.12, "origin", 0.0),
    ("rastrigin", rastrigin, 5.12, "shifted", 0.3 * 5.12),
    ("rosenbrock", rosenbrock, 5.0, "ones", 0.0),
):
    for optimiser in (BA.DevBA, SCA.OriginalSCA):
        begun, asked, found = time.perf_counter(), 0, []
        for seed in range(int(sys.argv[1])):
            evaluations, cost = search(optimiser, function, half, shift, seed)
            asked += evaluations
            found.append(cost)
            print(f"{name},{place},{optimiser.__name__},{evaluations},{seed},{cost:.9g}", flush=True)
        spent = (time.perf_counter() - begun) / asked
        print(
            f"{name} {place} {optimiser.__name__}: mean {np.mean(found):.4g}, median {np.median(found):.4g}, {1e6 * spent:.0f} us an evaluation",
            file=sys.stderr,
        )
