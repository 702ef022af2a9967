"""DevBA and OriginalSCA of mealpy on the sphere and on Rastrigin's function, 8 dimensions, 30 agents x 200 generations.

    mealpy_optimisers.py SEEDS   prints `function optimum optimiser fitness...`, one line each, and the time of an evaluation

The optimum stands at the origin, and, since sine cosine algorithms are drawn to zero, once more 30 % of the half width away from it.
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


evaluations, begun = 0, time.perf_counter()
for name, function, half in (("sphere", sphere, 10.0), ("rastrigin", rastrigin, 5.12)):
    for place, shift in (("origin", 0.0), ("shifted", 0.3 * half)):
        for optimiser in (BA.DevBA, SCA.OriginalSCA):
            found = []
            for seed in range(int(sys.argv[1])):

                def cost(x):
                    global evaluations
                    evaluations += 1
                    return function(x - shift)

                model = optimiser(epoch=GENERATIONS, pop_size=AGENTS)
                bounds = FloatVar(lb=(-half,) * DIMENSIONS, ub=(half,) * DIMENSIONS)
                model.solve({"bounds": bounds, "minmax": "min", "obj_func": cost, "log_to": None}, seed=seed)
                found.append(model.g_best.target.fitness)
            print(name, place, optimiser.__name__, *(f"{value:.6g}" for value in found), flush=True)
print("time", (time.perf_counter() - begun) / evaluations)
