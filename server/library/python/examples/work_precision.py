"""Work and precision of RK4 on the laboratory's stretched ball: work_precision.py [PICTURE]"""

import sys

import matplotlib.pyplot as plt
import numpy as np
import wobble

ball = wobble.problems()[0]
exact = ball.solve(20000).positions
runs = [ball.solve(steps) for steps in (50, 100, 200, 400, 800, 1600)]
errors = [np.sqrt(((run.positions - exact) ** 2).sum(axis=1).mean()) for run in runs]  # m
for run, error in zip(runs, errors):
    print(f"{run.evaluations:5} evaluations, {1e3 * run.seconds:6.2f} ms, error {error:.1e} m")
print(f"order {np.log2(errors[1] / errors[3]) / 2:.2f}")
plt.loglog([1e3 * run.seconds for run in runs], errors, "o-", label="RK4")
plt.xlabel("processor time / ms")
plt.ylabel("error / m, RMS over the vertices")
plt.title(ball.name)
plt.legend()
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "work_precision.png")
