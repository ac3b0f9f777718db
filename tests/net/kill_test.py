#!/usr/bin/env python3
"""A server that keeps its state is killed at random moments under bots, and goes on.

  kill_test.py BIN_FOLDER CACHE_FOLDER [--kills 2] [--bots 8] [--seed 1] [--scene pitch]

After each kill -9 the server is started again on the same port. The test fails unless it goes on from a state at most a
second old, every bot comes back to its own body within 3 s of the listening port, 95 of 100 within 2 s, and nobody is in
twice. All traffic is on 127.0.0.1.
"""
import argparse
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

WITHIN, WITHIN_95 = 3.0, 2.0  # s from the listening port
START_PATIENCE = 20.0  # s


class Server:
    """A run of wobbled, with the times of the lines of its log."""

    def __init__(self, args, port, state):
        command = [os.path.join(args.bin, 'wobbled'), '--scene', args.scene, '--port', str(port), '--bind', '127.0.0.1',
                   '--state', state, '--key', os.path.join(state, 'server.key'), '--cache', args.cache,
                   '--threads', '1', '--admit-when-busy', '--ops', '0']
        self.lines = []
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stdout:
            self.lines.append((time.monotonic(), line.rstrip()))

    def find(self, pattern):
        return [(at, found) for at, line in list(self.lines) if (found := re.search(pattern, line))]

    def wait_for(self, pattern, count, patience):
        end = time.monotonic() + patience
        while time.monotonic() < end:
            found = self.find(pattern)
            if len(found) >= count:
                return found
            if self.process.poll() is not None:
                break
            time.sleep(0.02)
        return self.find(pattern)

    def read_tick(self):
        """The world's tick. On a busy machine fewer of them pass in a second than the scene asks for."""
        ops = self.wait_for(r'metrics and health on TCP port (\d+)', 1, START_PATIENCE)[0][1].group(1)
        with urllib.request.urlopen(f'http://127.0.0.1:{ops}/metrics', timeout=START_PATIENCE) as answer:
            return int(re.search(r'^wobble_world_ticks_total (\d+)$', answer.read().decode(), re.MULTILINE).group(1))

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        self.reader.join()


def fail(server, why):
    print('\n'.join(line for _, line in server.lines[-40:]))
    sys.exit(f'kill_test: {why}')


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('bin')
    parser.add_argument('cache')
    parser.add_argument('--kills', type=int, default=2)
    parser.add_argument('--bots', type=int, default=8)
    parser.add_argument('--apart', type=float, default=10.5, help='seconds from one kill to the next, at least')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--scene', default='pitch')
    args = parser.parse_args()
    chance = random.Random(args.seed)
    delays, lost = [], []
    with tempfile.TemporaryDirectory() as state:
        server = Server(args, 0, state)
        listening = server.wait_for(r'listening on UDP port (\d+)', 1, START_PATIENCE)
        if not listening:
            fail(server, 'the server does not start')
        port = int(listening[0][1].group(1))
        bots = subprocess.Popen([os.path.join(args.bin, 'wobble'), 'bots', f'127.0.0.1:{port}', '--script', 'wander.lua',
                                 '--count', str(args.bots)], stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT)
        try:
            joined = server.wait_for(r'client (\d+) \(.*\) joined', args.bots, START_PATIENCE)
            players = sorted(int(found.group(1)) for _, found in joined)
            if len(players) < args.bots:
                fail(server, f'{len(players)} of {args.bots} bots joined')
            for number in range(args.kills):
                # A checkpoint comes each second; every moment between two of them is as likely. Clients count a loss
                # within 10 s of the last one as the same and wait longer each time.
                time.sleep(args.apart + chance.random())
                reached = server.read_tick()
                server.kill()
                server = Server(args, port, state)
                listening = server.wait_for(r'listening on UDP port', 1, START_PATIENCE)
                resumed = server.find(r'tick (\d+): the world goes on; (\d+) players')
                if not listening or not resumed:
                    fail(server, f'kill {number + 1}: the server does not go on')
                began = listening[0][0]
                lost.append((reached - int(resumed[0][1].group(1))) / 60)
                seats = int(resumed[0][1].group(2))
                if seats != args.bots:
                    fail(server, f'kill {number + 1}: {seats} of {args.bots} players may come back')
                back = server.wait_for(r'client (\d+) \(.*\) is back', args.bots, 2 * WITHIN)
                numbers = sorted(int(found.group(1)) for _, found in back)
                if numbers != players or server.find(r'\) joined'):
                    fail(server, f'kill {number + 1}: back are {numbers}, not {players}')
                delays += [at - began for at, _ in back]
        finally:
            bots.terminate()
            bots.wait()
            server.process.terminate()
            server.process.wait()
    delays.sort()
    at95 = delays[int(0.95 * (len(delays) - 1))]
    print(f'{args.kills} of {args.kills} kills resumed under {args.bots} bots; back after {delays[0]:.2f} s (least), '
          f'{at95:.2f} s (p95), {delays[-1]:.2f} s (most); world lost at most {max(lost):.2f} s')
    if delays[-1] > WITHIN or at95 > WITHIN_95:
        sys.exit(f'kill_test: bots come back too late; must be within {WITHIN} s, p95 {WITHIN_95} s')
    if max(lost) > 1.25:  # a second, and the time in which a checkpoint gets to the disk
        sys.exit('kill_test: more than a second of the world was lost')


if __name__ == '__main__':
    main()
