#!/usr/bin/env python3
"""Stepping from Python costs at most 2 % more than stepping in C++: a scene of 64 balls, a tick a call, against
wobble_world_step with all ticks in one call.

    overhead_test.py LIBWOBBLE_WORLD

Both play the same ticks of the same world in one process, in turns; the time is the processor time of this thread, and of
each stretch of ticks the least of many repetitions counts. Other load can only make them slower.
"""

import ctypes
import sys
import time

import wobble

MOST = 0.02
TICKS, STRETCHES, REPETITIONS = 4, 9, 40
MOST_ROUNDS = 4
BODIES = "".join(
    f'[[bodies]]\nblueprint = "ball"\nposition = [{x}, {y}, 1.2]\n' for x in range(0, 16, 2) for y in range(0, 16, 2)
)
SCENE = f"""
[[obstacle]]
kind = "plane"
[[blueprint]]
name = "ball"
radius = 0.5
mass = 8
stiffness = 150
gas = 330
{BODIES}
[player]
blueprint = "ball"
"""


class Options(ctypes.Structure):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("scene", ctypes.c_char_p),
        ("text", ctypes.c_char_p),
        ("folder", ctypes.c_char_p),
        ("seed", ctypes.c_uint64),
        ("tick_rate", ctypes.c_double),
        ("error_target", ctypes.c_double),
        ("threads", ctypes.c_uint32),
        ("substeps", ctypes.c_uint32),
    ]


library = ctypes.CDLL(sys.argv[1])
library.wobble_world_free.argtypes = [ctypes.c_void_p]
library.wobble_world_step.argtypes = [ctypes.c_void_p, ctypes.c_uint32, ctypes.c_void_p]


def load():
    options = Options(struct_size=ctypes.sizeof(Options), text=SCENE.encode())
    world = ctypes.c_void_p()
    message = ctypes.create_string_buffer(1000)
    if library.wobble_world_load(ctypes.byref(options), ctypes.byref(world), message, len(message)) != 0:
        sys.exit(message.value.decode())
    return world


def measure(step):
    began = time.thread_time()
    step()
    return time.thread_time() - began


def step_by_tick(world):
    for _ in range(TICKS):
        world.step()


def measure_both(repetition):
    """Plays one repetition, shortens the least times, and returns the world stepped from Python."""
    if repetition % 2 == 0:
        ours, theirs = wobble.World(text=SCENE), load()
    else:
        theirs, ours = load(), wobble.World(text=SCENE)
    turns = [
        (in_python, lambda: step_by_tick(ours)),
        (in_c, lambda: library.wobble_world_step(theirs, TICKS, None)),
    ]
    for i in range(STRETCHES):
        for least, step in turns if repetition % 2 == 0 else turns[::-1]:
            least[i] = min(least[i], measure(step))
    library.wobble_world_free(theirs)
    return ours


in_c, in_python = [[float("inf")] * STRETCHES for _ in range(2)]
# The least times only get nearer to the true ones: where a spell of other load was longer than the repetitions, more of
# them tell.
for _ in range(MOST_ROUNDS):
    for repetition in range(REPETITIONS):
        ours = measure_both(repetition)
    overhead = sum(in_python) / sum(in_c) - 1
    if overhead <= MOST:
        break
awake = ours.step().awake
tick = 1e6 * sum(in_c) / (TICKS * STRETCHES)
print(f"{awake} balls, {tick:.0f} us a tick: stepping from Python costs {100 * overhead:+.2f} %")
if awake != 64 or overhead > MOST:
    sys.exit(f"FAILED: 64 balls awake, at most {100 * MOST:.0f} %")
