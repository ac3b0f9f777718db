#!/usr/bin/env python3
"""The eggs of docker/panels: that both say the same, that the programs know what they say, and that what they start
runs as a panel runs it.

    python3 eggs_test.py BIN_DIR BASES

The start command runs as user 1000 with a root that is read-only but for the server's folder, in namespaces of its own,
which need root; without root it runs as this user. Exit code 0: all holds; 1: the first thing that does not is printed.
"""

import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request

import yaml

PANELS = pathlib.Path(__file__).resolve().parent.parent.parent / "docker" / "panels"


def expect(holds, what):
    if not holds:
        print(f"FAILED: {what}")
        sys.exit(1)


def read_eggs():
    """(Pterodactyl's, Pelican's) as they are read by the panels."""
    return (json.loads((PANELS / "egg-wobble.json").read_text()), yaml.safe_load((PANELS / "egg-wobble.yaml").read_text()))


def check_schema(pterodactyl, pelican):
    expect(pterodactyl["meta"]["version"] == "PTDL_v2" and pelican["meta"]["version"] == "PLCN_v3", "the versions")
    expect(pterodactyl["startup"] == pelican["startup_commands"]["Default"], "one start command")
    for key in ("name", "author", "description", "docker_images", "scripts"):
        expect(pterodactyl[key] == pelican[key], f"{key}: the same in both eggs")
    for key in ("files", "startup", "logs"):  # texts of JSON in the one, plain in the other
        expect(json.loads(pterodactyl["config"][key]) == pelican["config"][key], f"config.{key}: the same in both eggs")
    expect(pterodactyl["config"]["stop"] == pelican["config"]["stop"] == "^C", "Ctrl-C ends it")
    expect(len(pterodactyl["variables"]) == len(pelican["variables"]) > 0, "as many variables")
    for one, other in zip(pterodactyl["variables"], pelican["variables"]):
        for key in ("name", "description", "env_variable", "default_value", "user_viewable", "user_editable"):
            expect(one[key] == other[key], f"{key} of {one['name']}: the same in both eggs")
        expect(one["rules"].split("|") == other["rules"], f"rules of {one['name']}")


def make_environment(egg, home, port):
    values = {each["env_variable"]: each["default_value"] for each in egg["variables"]}
    return {"PATH": os.environ["PATH"], "HOME": str(home), "STATE_DIRECTORY": str(home), "STARTUP": egg["startup"],
            "SERVER_PORT": str(port), **values}


def take_port():
    """A port that is free for UDP and TCP just now."""
    while True:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp, socket.socket() as tcp:
            udp.bind(("127.0.0.1", 0))
            try:
                tcp.bind(("127.0.0.1", udp.getsockname()[1]))
            except OSError:
                continue
            return tcp.getsockname()[1]


def confine(folder, mounts, command):
    """The command as user 1000 in a mount namespace where only folder/home can be written. mounts: real folders, by what
    they are in `folder`, which the user can reach wherever the clone is."""
    script = ["set -e", "mount --make-rprivate /", f"mount --bind {folder}/home {folder}/home",
              f"mount -t tmpfs -o mode=1777 tmpfs {folder}/tmp"]  # panels give a small /tmp, too
    script += [f"mount --bind '{real}' {folder}/{name}" for name, real in mounts.items()]
    script += ["mount -o remount,bind,ro /", f"cd {folder}/home",
               'exec setpriv --reuid 1000 --regid 1000 --clear-groups --no-new-privs --inh-caps=-all "$@"']
    return ["unshare", "--mount", "sh", "-c", "; ".join(script), "sh", *command]


def read_until(process, text, seconds):
    lines = []
    deadline = time.monotonic() + seconds
    for line in process.stdout:
        lines.append(line)
        if text in line:
            return True, lines
        if time.monotonic() > deadline:
            break
    return False, lines


def run_egg(egg, programs, bases):
    folder = pathlib.Path(tempfile.mkdtemp())
    try:
        home = folder / "home"
        for name in ("home", "tmp", "bin", "bases", "panels"):
            (folder / name).mkdir()
        mounts = {"bin": programs, "bases": bases, "panels": PANELS}
        port = take_port()
        environment = make_environment(egg, home, port)
        is_confined = os.geteuid() == 0
        if is_confined:
            folder.chmod(0o755)
            os.chown(home, 1000, 1000)
            places = {name: folder / name for name in mounts}
        else:
            places = mounts
        environment["PATH"] = f"{places['bin']}:{environment['PATH']}"
        environment["WOBBLE_CACHE"] = str(places["bases"])
        environment["TMPDIR"] = str(folder / "tmp")
        command = ["sh", str(places["panels"] / "start.sh")]
        if is_confined:
            command = confine(folder, mounts, command)
        process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        done = json.loads(egg["config"]["startup"])["done"]
        is_up, lines = read_until(process, done, 60)
        expect(is_up, f"a line with '{done}'; came:\n{''.join(lines)}")
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=5) as answer:
            expect(answer.status == 200, "the page on the panel's port")
        bot = [f"{programs}/wobble", "bots", f"127.0.0.1:{port}", "--script", "wander.lua", "--count", "1", "--for", "1"]
        played = subprocess.run(bot, env=environment, capture_output=True, text=True, check=False)
        expect(played.returncode == 0, f"a bot that plays on the panel's port; came:\n{played.stderr}")
        process.send_signal(2)
        expect(process.wait(20) == 0, "exit code 0 after Ctrl-C")
        expect((home / "worlds.toml").exists(), "worlds.toml in the server's folder")
        expect(not is_confined or all(path.stat().st_uid == 1000 for path in home.rglob("*")), "files of user 1000 only")
    finally:
        shutil.rmtree(folder)


def main():
    programs, bases = (pathlib.Path(each).resolve() for each in sys.argv[1:3])
    pterodactyl, pelican = read_eggs()
    check_schema(pterodactyl, pelican)
    known = subprocess.run([programs / "wobble", "host", "--help"], capture_output=True, text=True, check=True).stdout
    known += subprocess.run([programs / "wobbled", "--help"], capture_output=True, text=True, check=True).stdout
    for each in pterodactyl["variables"]:
        name = each["env_variable"]
        expect(name == "WOBBLE_BOTS" or re.search(rf"\b{name}\b", known), f"--help to know {name}")
    run_egg(pterodactyl, programs, bases)
    print("the eggs hold")


main()
