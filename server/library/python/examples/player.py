"""Plays for ten seconds: rolls its own ball in a circle and prints where it is. player.py HOST:PORT [SECONDS]"""

import math
import sys
import time

import wobble

seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 10
with wobble.Client(sys.argv[1], name="example") as client:  # `with` says goodbye at the end
    begin = printed = now = time.monotonic()
    while client.state != "ended" and now < begin + seconds:
        client.update()  # receives, answers and sends
        client.set_input((math.cos(now), math.sin(now)))  # along the world's x and y, each -1 to 1
        for body in client.sample().bodies:  # all bodies as they are to be drawn
            if body.number == client.own_body and now > printed + 0.5:
                x, y, z = body.centroid  # metres, z is up
                print(f"x {x:6.2f}  y {y:6.2f}  z {z:6.2f}", flush=True)
                printed = now
        time.sleep(1 / 60)
        now = time.monotonic()
    if client.state == "ended":
        sys.exit(f"player.py: {client.reason}")
