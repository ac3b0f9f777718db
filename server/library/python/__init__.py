"""Worlds of soft bodies: simulate them, play recordings of servers, and play on servers.

>>> import wobble
>>> world = wobble.World("ball_drop")
>>> ball = world.bodies[0]
>>> x = ball.positions  # a numpy array over the engine's memory, which is always up to date
>>> report = world.step(30)
>>> round(float((ball.origin + x)[:, 2].mean()), 1)
1.8

Units are SI; z is up. README.md, beside this file, has more.
"""

from wobble._wobble import (
    Body,
    Client,
    Energy,
    Event,
    Frame,
    Ground,
    Obstacle,
    Particle,
    Problem,
    Recording,
    Report,
    Score,
    Scoreboard,
    ShownBody,
    Solution,
    Spring,
    Tuning,
    Workshop,
    World,
    __version__,
    problems,
)

__all__ = [
    "Body",
    "Client",
    "Energy",
    "Event",
    "Frame",
    "Ground",
    "Obstacle",
    "Particle",
    "Problem",
    "Recording",
    "Report",
    "Score",
    "Scoreboard",
    "ShownBody",
    "Solution",
    "Spring",
    "Tuning",
    "Workshop",
    "World",
    "__version__",
    "problems",
]

for _name in __all__:
    if isinstance(globals()[_name], type):
        globals()[_name].__module__ = "wobble"
