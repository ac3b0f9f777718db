#!/usr/bin/env python3
"""The examples of the Python module, as a person runs them, in short.

    examples_test.py EXAMPLES WOBBLED
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

examples, wobbled = Path(sys.argv[1]), sys.argv[2]


def run(name, *arguments):
    command = [sys.executable, examples / name, *map(str, arguments)]
    environment = os.environ | {"MPLBACKEND": "agg"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=60)
    print(done.stdout, done.stderr, sep="", end="")
    assert done.returncode == 0, name
    return done.stdout


def read_number(pattern, text):
    found = re.search(pattern, text)
    assert found, pattern
    return float(found.group(1))


with tempfile.TemporaryDirectory() as folder:
    order = read_number(r"order ([\d.]+)", run("work_precision.py", "plot.png"))
    assert 3.8 < order < 4.2, order
    assert (Path(folder) / "plot.png").read_bytes().startswith(b"\x89PNG")
    lines = (examples / "work_precision.py").read_text().split('"""', 2)[2].strip().split("\n")
    assert len([line for line in lines if line]) <= 20, "twenty lines"

    run("drops.py", 20, "drops.npz")
    data = np.load(Path(folder) / "drops.npz")
    begin, end = data["inputs"], data["outputs"]
    assert begin.shape == end.shape == (20, 2, 42, 3) and np.isfinite(end).all()
    assert begin[:, 0, :, 2].mean() > 1.9 and -0.1 < end[:, 0, :, 2].min() < 0.1, "balls fall onto the ground"
    assert len({x.tobytes() for x in begin}) == 20, "every drop is another one"
    run("drops.py", 20, "again.npz")
    assert (np.load(Path(folder) / "again.npz")["outputs"] == end).all(), "the same data again"

    server = subprocess.Popen(
        [wobbled, "--scene", "sumo", "--port", "0", "--for", "60", "--untrained"], stdout=subprocess.PIPE, text=True
    )
    try:
        port = next(found[1] for line in server.stdout if (found := re.match(r"listening on UDP port (\d+)", line)))
        places = re.findall(r"^x +(\S+)  y +(\S+)  z +(\S+)$", run("player.py", f"127.0.0.1:{port}", 2.5), re.MULTILINE)
        assert len(places) >= 2 and len(set(places)) > 1, places
        told = run("bot.py", f"127.0.0.1:{port}", 3)
        assert "join numpy" in told
        assert read_number(r"rolled ([\d.]+) m in sumo", told) > 1
    finally:
        server.terminate()
        server.communicate()
