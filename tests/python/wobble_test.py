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


HILL = """
[[obstacle]]
kind = "height_field"
position = [100, 50, 1]
cell_size = 2
heights = [[0, 1, 2], [3, 4, 5]]
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
        self.assertEqual((client.sample().positions.shape, client.sample().bodies), ((0, 3), []))
        none = float("nan")
        for error, text, call in (
            (ValueError, "update: now is", lambda: client.update(now=4)),
            (ValueError, "update: now is", lambda: client.update(now=none)),
            (ValueError, r"move has shape \(3,\)", lambda: client.set_input((0, 0, 1))),
            (ValueError, "set_input: a number", lambda: client.set_input((2, 0))),
            (ValueError, "target: number 0 is nan", lambda: client.grab(1, 0, (none, 0, 0))),
            (RuntimeError, "only a client that plays", lambda: client.push(1, 0, (0, 0, 1))),
            (ValueError, "password, token, invite", lambda: wobble.Client("127.0.0.1:9", password="a", token="b")),
        ):
            with self.subTest(text), self.assertRaisesRegex(error, text):
                call()

    def test_a_frame_is_the_users(self):
        scene = tempfile.NamedTemporaryFile("w", suffix=".toml")
        self.addCleanup(scene.close)
        scene.write(Path(os.environ["WOBBLED"]).with_name("scenes").joinpath("ball_drop.toml").read_text() + HILL)
        scene.flush()
        command = [os.environ["WOBBLED"], "--scene", scene.name, "--port", "0", "--for", "60", "--untrained"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
            try:
                port = next(line.split()[4] for line in server.stdout if line.startswith("listening on UDP port"))
                frames = []
                with wobble.Client(f"127.0.0.1:{port.rstrip(',')}", name="frames") as client:
                    end = time.monotonic() + 20
                    while len(frames) < 20 and time.monotonic() < end:
                        client.update()
                        frame = client.sample()
                        if len(frame.bodies) == 5:
                            frames.append((frame, frame.positions.copy()))
                        time.sleep(0.01)
                    self.assertEqual(client.state, "playing")
                    self.assertEqual((client.hands, client.reach), (["grab", "cut", "push"], 0))
                    self.assertTrue(0 < client.pace <= 1)  # of a busy machine less than 1
                    (hill,), (plane,) = client.grounds, client.obstacles
                    self.assertEqual(hill.corner.tolist(), [100, 50])
                    extent = hill.cell_size * (np.array(hill.heights.shape) - 1)  # the server cuts cells finer
                    np.testing.assert_allclose(extent, [2, 4])
                    corners = hill.heights[[0, 0, -1, -1], [0, -1, 0, -1]]
                    np.testing.assert_allclose(corners, [1, 3, 4, 6], atol=1e-3)
                    self.assertEqual((plane.kind, plane.a.tolist(), plane.b[0]), ("plane", [0, 0, 1], 0))
                self.assertEqual(client.state, "ended")
            finally:
                server.terminate()
        self.assertEqual(len(frames), 20)
        for frame, copy in frames:
            self.assertTrue(np.array_equal(frame.positions, copy))  # later samples do not touch it
            self.assertEqual(sum(len(body.positions) for body in frame.bodies), len(frame.positions))
            self.assertLess(frame.faces.max(), len(frame.positions))
            for body in frame.bodies:
                corners = frame.positions[body.faces]
                self.assertLess(np.abs(corners.mean(axis=(0, 1)) - body.centroid).max(), 0.2)
                self.assertTrue(np.shares_memory(body.positions, frame.positions))
        self.assertTrue((frames[0][1] != frames[-1][1]).any())


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
