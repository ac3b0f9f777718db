#!/usr/bin/env python3
"""The wheel, packed from the build and installed by pip into an empty folder without a network, simulates and connects.

    wheel_test.py WHEELS PACKER LICENSE    (the folder with the wheel; wheel.py)
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

wheels, packer, license_file = map(Path, sys.argv[1:])
CHECK = """
import pathlib, wobble
world = wobble.World("arena")
world.step()
assert pathlib.Path(wobble.__file__).is_relative_to(pathlib.Path.cwd()), wobble.__file__
for name in ("py.typed", "__init__.pyi", "README.md", "examples/bot.py", "scenes/arena.toml"):
    assert (pathlib.Path(wobble.__file__).parent / name).exists(), name
wobble.Client("127.0.0.1:9").update()
print("the wheel's", wobble.__version__, world.bodies[0])
"""


def run(*command, **options):
    done = subprocess.run(command, text=True, capture_output=True, **options)
    if done.returncode != 0:
        sys.exit(f"FAILED {command}: {done.stdout}{done.stderr}")
    return done.stdout


(wheel,) = wheels.glob("*.whl")
content = wheel.read_bytes()
with tempfile.TemporaryDirectory() as folder:
    package = wheels / "installed/lib/python3/dist-packages/wobble"
    run(sys.executable, packer, package, wheel.name.split("-")[1], license_file, Path(folder) / "again")
    assert (Path(folder) / "again" / wheel.name).read_bytes() == content, "the same files give the same bytes"
    pip = ["-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--disable-pip-version-check"]
    run(sys.executable, *pip, "--target", folder, wheel)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    # Nothing of the build is near: scenes are the wheel's own.
    print(run(sys.executable, "-c", CHECK, cwd=folder, env=environment).strip(), f"{len(content) / 1e6:.1f} MB")
