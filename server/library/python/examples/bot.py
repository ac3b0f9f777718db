"""Plays, and learns nothing: it rolls at the nearest other body and keeps off the rim. bot.py HOST:PORT [SECONDS]"""

import sys
import time

import numpy as np
import wobble


def choose(own: wobble.ShownBody, others: list[wobble.ShownBody]) -> tuple[np.ndarray, bool]:
    """Where to roll, and whether to jump."""
    place = own.centroid[:2]
    move = -place / 6  # to the middle, and the more so the farther out
    distance = np.inf
    if others:
        ways = np.array([other.centroid[:2] for other in others]) - place
        distances = np.linalg.norm(ways, axis=1)
        distance = distances.min()
        move = move + ways[distances.argmin()] / max(distance, 1e-3)
    return move / max(1, np.linalg.norm(move)), distance < 1.5


seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 60
end, rolled, last = time.monotonic() + seconds, 0.0, None
with wobble.Client(sys.argv[1], name="numpy") as client:
    while client.state != "ended" and time.monotonic() < end:
        client.update()
        bodies = client.sample().bodies
        for own in bodies:
            if own.number == client.own_body:
                move, jump = choose(own, [body for body in bodies if body is not own])
                client.set_input(move, jump=jump)
                rolled += 0 if last is None else float(np.linalg.norm(own.centroid - last))
                last = own.centroid
        for event in client.events():
            print(event.kind, event.text)
        time.sleep(1 / 60)
    print(f"rolled {rolled:.1f} m in {client.scene}; {client.reason or 'played to the end'}")
