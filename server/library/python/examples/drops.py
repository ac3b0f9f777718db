"""Training data from random drops, on all cores: drops.py [COUNT [FILE]]

A ball is turned at random, thrown at random, and followed for a second. The file has, for each drop, where its vertices
are and how they move at the beginning (inputs) and at the end (outputs), in metres and metres a second.
"""

import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import wobble

SCENE = """
[[obstacle]]
kind = "plane"
[[blueprint]]
name = "ball"
subdivisions = 1
radius = 0.5
mass = 4
stiffness = 150
gas = 150
[player]
blueprint = "ball"
"""


def drop(number: int) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(number)
    world = wobble.World(text=SCENE, precision="double")
    ball = world.add("ball", position=(0, 0, 2))
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    turn[:, 0] *= np.linalg.det(turn)  # a rotation, not a reflection
    places = ball.rest @ turn.T + (0, 0, 2)
    ball.set_motion(places, np.broadcast_to(random.normal(scale=2, size=3), places.shape))
    begin = np.stack([ball.places, ball.velocities])
    world.step(60)  # without Python's lock, so threads are enough
    return begin, np.stack([ball.places, ball.velocities])


count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
began = time.perf_counter()
with ThreadPoolExecutor(os.cpu_count()) as pool:
    inputs, outputs = (np.array(side) for side in zip(*pool.map(drop, range(count))))
np.savez_compressed(sys.argv[2] if len(sys.argv) > 2 else "drops.npz", inputs=inputs, outputs=outputs)
print(f"{count} drops in {time.perf_counter() - began:.1f} s: {inputs.shape} -> {outputs.shape}")
