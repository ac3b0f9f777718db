#!/usr/bin/env python3
"""The Python module as its users meet it: views that never dangle, errors that name what is wrong, threads side by side.

The module is found by PYTHONPATH. WOBBLE_RECORDING: a recording of 150 ticks of sumo. WOBBLED: the server.
"""

import gc
import os
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np
import wobble

TEARING = """
[[obstacle]]
kind = "plane"
[[blueprint]]
name = "cloth"
kind = "cloth"
points = [8, 8]
tear_stretch = 1.05
[player]
blueprint = "cloth"
"""


class Worlds(unittest.TestCase):
    def setUp(self):
        self.world = wobble.World("ball_drop", seed=3)
        self.ball = self.world.bodies[0]

    def test_a_view_follows_the_body_without_a_copy(self):
        x, v = self.ball.positions, self.ball.velocities
        again = self.ball.positions
        self.assertEqual(x.__array_interface__["data"], again.__array_interface__["data"])
        self.assertFalse(x.flags.owndata or x.flags.writeable or v.flags.writeable)
        before = x.copy()
        self.world.step(20)
        self.assertTrue((x != before).any())
        self.assertTrue(np.array_equal(self.ball.origin + x, self.ball.places))
        self.assertLess(v[:, 2].mean(), -3)  # m/s, after a third of a second
        with self.assertRaises(ValueError):
            x.flags.writeable = True

    def test_precisions(self):
        self.assertEqual(self.ball.positions.dtype, np.float32)
        double = wobble.World("ball_drop", precision="double", substeps=8).bodies[0]
        self.assertEqual(double.positions.dtype, np.float64)
        np.testing.assert_allclose(double.places, self.ball.places, atol=1e-6)

    def test_a_viewed_body_is_not_removed(self):
        tip = self.ball.positions[3, 1:]  # a view of a view
        with self.assertRaisesRegex(BufferError, "body 1: arrays view its state"):
            self.ball.remove()
        self.world.step(5)
        self.assertTrue(np.isfinite(tip).all())
        del tip
        gc.collect()
        self.ball.remove()
        for ask in (lambda: self.ball.positions, self.ball.energy, self.ball.remove, lambda: self.world.body(1)):
            with self.assertRaisesRegex(LookupError, "body 1"):
                ask()
        self.assertEqual([body.number for body in self.world.bodies], [2, 3, 4])

    def test_a_view_outlives_its_world(self):
        x = self.ball.positions
        before = x.copy()
        del self.world, self.ball
        gc.collect()
        self.assertTrue(np.array_equal(x, before))

    # Bodies that come and go move all others in the list; what tears or is reset gets another state.
    def test_views_stay_right_whatever_happens_to_the_world(self):
        world = wobble.World(text=TEARING)
        cloths = [world.add("cloth", (3 * i, 0, 3)) for i in range(3)]
        views = [cloth.positions for cloth in cloths]
        others = [world.add("cloth", (3 * i, 9, 3)) for i in range(20)]
        for other in others[::2]:
            other.remove()
        wild = np.zeros((64, 3))
        wild[::2] = (1e6, -1e6, 0)  # m/s
        cloths[1].set_motion(cloths[1].places, wild)
        thrown = np.random.default_rng(1).normal(scale=30, size=(64, 3))
        cloths[2].set_motion(cloths[2].places, thrown)
        report = world.step(60)
        self.assertGreater(report.torn, 0)
        self.assertGreater(report.reset, 0)
        for cloth, view in zip(cloths, views):
            self.assertTrue(np.array_equal(view, cloth.positions))
            self.assertTrue(np.array_equal(cloth.origin + view, cloth.places))

    def test_acts(self):
        world = wobble.World("ball_drop", tick_rate=240, precision="double")
        world.gravity = (0, 0, 0)
        ball = world.bodies[2]
        ball.push(2.4 * ball.masses[:, None] * [1, 0, 0])  # 2.4 m/s² for one tick
        world.step()
        self.assertAlmostEqual(ball.masses @ ball.velocities[:, 0] / ball.mass, 0.01, places=6)
        forces = ball.forces()
        sum_of_all = sum(force for name, force in forces.items() if name != "accelerations")
        np.testing.assert_allclose(sum_of_all / ball.masses[:, None], forces["accelerations"], rtol=1e-6, atol=1e-6)
        ball.set_control((1, 0), puff=True)
        world.step(30)
        self.assertGreater(ball.velocities[:, 0].mean(), 0.1)
        self.assertEqual(world.add("ball42", (0, 0, 9)).blueprint, "ball42")

    def test_the_same_calls_give_the_same_bits(self):
        other = wobble.World("ball_drop", seed=3, threads=2)
        self.world.step(40)
        for _ in range(40):
            other.step()
        self.assertEqual(self.world.hash, other.hash)

    def test_errors_name_what_is_wrong(self):
        none = float("nan")
        for error, text, call in (
            (ValueError, "either a scene or its text", lambda: wobble.World()),
            (ValueError, "scene 'nowhere' is not known", lambda: wobble.World("nowhere")),
            (ValueError, "tick_rate = 0.5: must be 1 to 1000", lambda: wobble.World("pair", tick_rate=0.5)),
            (ValueError, "threads = 65: must be 1 to 64", lambda: wobble.World("pair", threads=65)),
            (ValueError, "seed = 0", lambda: wobble.World("pair", seed=0)),
            (ValueError, "precision = 'half'", lambda: wobble.World("pair", precision="half")),
            (ValueError, "scene:2: mass = -1", lambda: wobble.World(text='[[blueprint]]\nmass = -1\n')),
            (TypeError, "step", lambda: self.world.step(-1)),
            (LookupError, "body 99", lambda: self.world.body(99)),
            (LookupError, "blueprint 'x'", lambda: self.world.add("x", (0, 0, 1))),
            (ValueError, "position: number 2 is nan", lambda: self.world.add("ball42", (0, 0, none))),
            (ValueError, r"forces has shape \(1, 2\)", lambda: self.ball.push([[1, 2]])),
            (IndexError, "vertices has 12", lambda: self.ball.push([[1, 2, 3]], [12])),
            (ValueError, r"positions has shape \(3,\)", lambda: self.ball.set_motion((1, 2, 3), (1, 2, 3))),
            (ValueError, "move is longer than 1", lambda: self.ball.set_control((1, 1))),
            (OSError, "/nowhere does not exist", lambda: wobble.Recording("/nowhere")),
            (ValueError, "steps = 0", lambda: wobble.problems()[0].solve(0)),
            (ValueError, "method = 'rk5'", lambda: wobble.problems()[0].solve(1, method="rk5")),
        ):
            with self.subTest(text), self.assertRaisesRegex(error, text):
                call()


# Behind ball_drop: a hill, a workshop with two particles and a spring, and a game that waits for its players.
MORE = """
[[obstacle]]
kind = "height_field"
position = [100, 50, 1]
cell_size = 2
heights = [[0, 1, 2], [3, 4, 5]]
[[blueprint]]
name = "bridge"
kind = "graph"
particle = [{ position = [-6, 5, 2], mass = 0.5, fixed = true }, { position = [-5, 5, 2], mass = 0.25 }]
spring = [{ ends = [0, 1], stiffness = 500, damping = 3 }]
[[bodies]]
blueprint = "bridge"
[workshop]
blueprint = "bridge"
[game]
kind = "sumo"
points = 7
rounds = 3
lobby = 600
"""


class Threads(unittest.TestCase):
    # A step holds neither Python's lock nor another world.
    def test_worlds_step_side_by_side(self):
        long, short = wobble.World("crowd"), wobble.World("pair")
        thread = threading.Thread(target=long.step, args=[48])
        began = time.perf_counter()
        thread.start()
        stamps = [began]
        while thread.is_alive():
            short.step()
            stamps.append(time.perf_counter())
        self.assertLess(np.diff(stamps).max(), (stamps[-1] - began) / 2)

    # What one thread views, pushes, adds and removes while another one steps: errors at most, never a crash.
    def test_one_world_in_many_threads(self):
        world = wobble.World("ball_drop")
        faults = []

        def play(number):
            random = np.random.default_rng(number)
            try:
                for _ in range(400):
                    bodies = world.bodies
                    body = bodies[random.integers(len(bodies))] if bodies else world.add("ball12", (0, 0, 2))
                    try:
                        match random.integers(5):
                            case 0:
                                world.step(2)
                            case 1:
                                body.positions.sum() + body.velocities[0].sum()
                            case 2:
                                body.push(np.ones((len(body.masses), 3)))
                            case 3:
                                body.remove()
                            case _:
                                world.add("ball42", random.normal(scale=2, size=3) + (0, 0, 5))
                    except (BufferError, LookupError):
                        pass
            except Exception as fault:
                faults.append(fault)

        threads = [threading.Thread(target=play, args=[i]) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(faults, [])


class Recordings(unittest.TestCase):
    def test_is_played_and_wound(self):
        film = wobble.Recording(os.environ["WOBBLE_RECORDING"])
        self.assertEqual((film.scene, film.first_tick, film.last_tick), ("sumo", 0, 150))
        film.step(50)
        then, places, body = film.hash, film.bodies[0].places, film.bodies[0]
        copy = body.positions
        self.assertEqual(film.step(1000).ticks, 100)
        film.seek(50)
        self.assertEqual(film.hash, then)
        self.assertTrue(np.array_equal(film.bodies[0].places, places))
        self.assertTrue(np.array_equal(film.bodies[0].positions, copy))
        with self.assertRaisesRegex(ValueError, "tick 151"):
            film.seek(151)
        with self.assertRaisesRegex(RuntimeError, "plays what was recorded"):
            body.push(np.zeros_like(copy))


class Clients(unittest.TestCase):
    def test_wrong_calls(self):
        client = wobble.Client("127.0.0.1:9", now=5)
        client.update(now=6)
        self.assertEqual((client.state, client.own_body, client.events()), ("joining", 0, []))
        self.assertEqual((client.hands, client.obstacles, client.grounds), ([], [], []))
        self.assertEqual((client.talk, client.scoreboard, client.workshop, client.tuning.may), ([], None, None, []))
        self.assertEqual((client.sample().positions.shape, client.sample().bodies), ((0, 3), []))
        none = float("nan")
        for error, text, call in (
            (ValueError, "update: now is", lambda: client.update(now=4)),
            (ValueError, "update: now is", lambda: client.update(now=none)),
            (ValueError, r"move has shape \(3,\)", lambda: client.set_input((0, 0, 1))),
            (ValueError, "set_input: a number", lambda: client.set_input((2, 0))),
            (ValueError, "target: number 0 is nan", lambda: client.grab(1, 0, (none, 0, 0))),
            (RuntimeError, "only a client that plays", lambda: client.push(1, 0, (0, 0, 1))),
            (RuntimeError, "say: only a client that plays", lambda: client.say("hello")),
            (ValueError, "say: a number is not finite or out of its range, or a text", lambda: client.say(201 * "a")),
            (ValueError, "order: a zero byte", lambda: client.order("kick 7\0")),
            (ValueError, "rename: a number", lambda: client.rename("")),
            (ValueError, "sign = 'smile': must be wave", lambda: client.emote("smile")),
            (ValueError, "must be given", lambda: client.tune()),
            (ValueError, r"gravity has shape \(2,\)", lambda: client.tune(gravity=(0, 1))),
            (ValueError, "tune: a number is not", lambda: client.tune(gravity=(0, 0, 1), stiffness=none)),
            (ValueError, "add_spring: a number", lambda: client.add_spring(1, 65536)),
            (ValueError, "at: number 1 is nan", lambda: client.add_particle((0, none, 0))),
            (TypeError, "remove_particle", lambda: client.remove_particle(-1)),
            (ValueError, "password, token, invite", lambda: wobble.Client("127.0.0.1:9", password="a", token="b")),
        ):
            with self.subTest(text), self.assertRaisesRegex(error, text):
                call()


class Players(unittest.TestCase):
    """On one server, which wants tokens: they say who is an owner."""

    @classmethod
    def setUpClass(cls):
        place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(place.cleanup)
        wobbled = Path(os.environ["WOBBLED"])
        scene, cls.key = Path(place.name, "scene.toml"), Path(place.name, "token.key")
        scene.write_text(wobbled.with_name("scenes").joinpath("ball_drop.toml").read_text() + MORE)
        options = ["--port", "0", "--for", "60", "--untrained", "--token-key", cls.key]
        server = subprocess.Popen([wobbled, "--scene", scene, *options], stdout=subprocess.PIPE, text=True)
        cls.addClassCleanup(server.stdout.close)
        cls.addClassCleanup(server.wait)
        cls.addClassCleanup(server.kill)  # to end well takes it a second
        port = next(line.split()[4] for line in server.stdout if line.startswith("listening on UDP port"))
        cls.address = f"127.0.0.1:{port.rstrip(',')}"

    def join(self, name, rank, **options):
        command = [Path(os.environ["WOBBLED"]).with_name("wobble"), "token", "--key", self.key, "--rank", rank]
        token = subprocess.check_output(command, text=True).strip()
        return wobble.Client(self.address, name=name, token=token, **options)

    def test_a_frame_is_the_users(self):
        frames = []
        with self.join("frames", "player", predict=False) as client:
            end = time.monotonic() + 20
            while len(frames) < 20 and time.monotonic() < end:
                client.update()
                client.set_input((1, 0))
                frame = client.sample()
                if len(frame.bodies) == 6:
                    frames.append((frame, frame.positions.copy()))
                time.sleep(0.01)
            self.assertEqual((client.state, client.rank), ("playing", "player"))
            self.assertEqual((client.hands, client.reach), (["grab", "cut", "push", "build"], 0))
            self.assertTrue(0 < client.pace <= 1)  # of a busy machine less than 1
            (hill,), (plane,) = client.grounds, client.obstacles
            self.assertEqual(hill.corner.tolist(), [100, 50])
            extent = hill.cell_size * (np.array(hill.heights.shape) - 1)  # the server cuts cells finer
            np.testing.assert_allclose(extent, [2, 4])
            corners = hill.heights[[0, 0, -1, -1], [0, -1, 0, -1]]
            np.testing.assert_allclose(corners, [1, 3, 4, 6], atol=1e-3)
            self.assertEqual((plane.kind, plane.a.tolist(), plane.b[0]), ("plane", [0, 0, 1], 0))
        self.assertEqual(client.state, "ended")
        self.assertEqual(len(frames), 20)
        for frame, copy in frames:
            self.assertTrue(np.array_equal(frame.positions, copy))  # later samples do not touch it
            self.assertEqual(sum(len(body.positions) for body in frame.bodies), len(frame.positions))
            self.assertLess(frame.faces.max(), len(frame.positions))
            for body in frame.bodies:
                self.assertFalse(body.lead.any())
                self.assertTrue(np.shares_memory(body.positions, frame.positions))
                if body.blueprint == "bridge":
                    continue  # has no faces
                corners = frame.positions[body.faces]
                self.assertLess(np.abs(corners.mean(axis=(0, 1)) - body.centroid).max(), 0.2)
        self.assertTrue((frames[0][1] != frames[-1][1]).any())

    def test_an_owner_talks_gives_orders_tunes_and_builds(self):
        with self.join("Ada", "owner") as client:
            self.events = []

            def wait_until(is_true, what):
                end = time.monotonic() + 20
                while not is_true():
                    self.assertLess(time.monotonic(), end, what)
                    time.sleep(0.005)
                    client.update()
                    self.frame = client.sample()
                    self.events += client.events()

            def has_come(kind, text, emote=""):
                return lambda: (kind, text, emote) in [(e.kind, e.text, e.emote) for e in self.events]

            wait_until(lambda: client.state == "playing" and client.workshop.particles, "a player with a workshop")
            self.assertEqual((client.rank, client.talk), ("owner", ["say", "emote"]))
            self.assertEqual(client.description, "balls of 12, 42, 162 and 642 vertices fall on a plane")
            client.set_input((0, 1))
            own = lambda: next((b for b in self.frame.bodies if b.number == client.own_body), None)
            wait_until(lambda: own() and own().lead[1] > 0, "an own body that is ahead")

            client.say("good evening")
            client.emote("cheer")
            client.rename("Ada L")
            client.order("players")
            wait_until(has_come("said", "good evening"), "a line")
            wait_until(has_come("emoted", "", "cheer"), "an emote")
            wait_until(has_come("renamed", "Ada L"), "a name")
            wait_until(lambda: any(e.kind == "notice" and "Ada" in e.text for e in self.events), "an answer")

            board = client.scoreboard
            self.assertEqual((board.game, board.phase, board.rounds), ("sumo", "lobby", 3))
            self.assertEqual((board.points_to_win, board.winner, board.bearer, board.side_points), (7, 0, 0, (0, 0)))
            ready = lambda: [(s.client_id, s.is_ready, s.is_bot, s.side) for s in client.scoreboard.scores]
            self.assertEqual(ready(), [(client.client_id, False, False, 0)])
            client.order("ready")
            wait_until(lambda: ready() == [(client.client_id, True, False, 0)], "a player who is ready")

            (nail, tip), (spring,) = client.workshop.particles, client.workshop.springs
            self.assertEqual((nail.mass, nail.is_fixed, tip.mass, tip.is_fixed), (0.5, True, 0.25, False))
            self.assertEqual((spring.ends, spring.stiffness, spring.damping, spring.owner), ((0, 1), 500, 3, 0))
            bridge = next(b for b in self.frame.bodies if b.number == client.workshop.body)
            client.add_particle(bridge.positions[0] + (0, 0.5, 0), mass=2, fixed=True)
            wait_until(lambda: len(client.workshop.particles) == 3, "another particle")
            added = client.workshop.particles[2]
            self.assertEqual((added.owner, added.mass, added.is_fixed), (client.client_id, 2, True))
            client.add_spring(nail.number, added.number, stiffness=200, damping=2)
            wait_until(lambda: len(client.workshop.springs) == 2, "another spring")
            self.assertAlmostEqual(client.workshop.springs[1].rest_length, 0.5, places=3)
            client.set_spring(spring.number, stiffness=300, damping=1, rest_length=1.5)
            client.set_particle(tip.number, mass=1)
            wait_until(lambda: client.workshop.springs[0].stiffness == 300, "a spring that is softer")
            wait_until(lambda: client.workshop.particles[1].mass == 1, "a particle that is heavier")
            client.remove_spring(spring.number)
            client.remove_particle(added.number)
            wait_until(lambda: len(client.workshop.particles) == 2, "a particle gone, and the spring at it")
            self.assertEqual(client.workshop.springs, [])

            self.assertEqual(client.tuning.may, ["gravity", "stiffness", "time"])
            client.tune(gravity=(0, 0, -5), time_rate=0.5)
            wait_until(lambda: client.tuning.gravity[2] == -5 and client.tuning.time_rate == 0.5, "another gravity")
            self.assertEqual(client.tuning.stiffness, 1)
            gains = []  # the world's time over its own slow pace; a busy machine jumps slowly

            def has_jumped():
                gains.append(client.statistics["server_time"] - 0.5 * time.monotonic())
                return gains[-1] > min(gains) + 1

            client.jump_ahead(10)
            wait_until(has_jumped, "a world that is ahead")


class Problems(unittest.TestCase):
    def test_methods_have_their_orders(self):
        ball = wobble.problems()[0]
        exact = ball.solve(4000).positions
        for method, order in (("rk4", 4), ("velocity_verlet", 2), ("semi_implicit_euler", 1)):
            coarse, fine = (np.abs(ball.solve(n, method=method).positions - exact).max() for n in (200, 400))
            self.assertAlmostEqual(np.log2(coarse / fine), order, delta=0.2)

    def test_energy_stays(self):
        ball = wobble.problems()[0]
        end = ball.solve(2000)
        begin = ball.energy(ball.positions, ball.velocities)
        self.assertAlmostEqual(ball.energy(end.positions, end.velocities), begin, delta=1e-6)
        self.assertGreater(ball.energy(1.01 * ball.positions, ball.velocities), begin + 1)
        self.assertEqual(end.evaluations, 8000)


if __name__ == "__main__":
    sys.exit(unittest.main())
