#!/usr/bin/env python3
"""The longer run, in parts: what is too slow for `make test`.

    python3 tests/nightly.py K/N          the K-th of N parts (make nightly PART=K/N)
    python3 tests/nightly.py JOB          one job alone (make nightly PART=JOB)
    python3 tests/nightly.py --list N     the jobs of each part, with the minutes that they take on two cores

Jobs are dealt out by their minutes, the longest first to the part that has least; seven parts take up to 120 minutes
each. A job that has passed at this commit is not run again, so a part that was interrupted goes on where it was. Each
job leaves tests/bench/results/nightly/JOB.json: commit, host's processor, minutes, exit code, and the figures that it
has. Its output is in build/nightly/JOB.log. The exit code is 0 when every job of the part has passed, 1 when one has
failed, 2 for a bad call.
"""

import json
import os
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "tests" / "bench" / "results" / "nightly"
LOGS = ROOT / "build" / "nightly"
LONGEST_PART = 120  # minutes

REPORTS = {  # minutes of a full report
    "accuracy": 13, "throughput": 6, "skip": 2, "contact": 8, "codec": 4, "interpolation": 4, "link": 12, "capacity": 16}
# Its parts, by a word of their names. The cloth pile has not been played whole.
STABILITY = {"limits": 3, "perturbations": 1, "growth": 1, "broken": 12, "stress": 5, "stacks": 15, "pile": 120}
RANDOM_SEEDS = range(1, 11)  # of 10,000 random trials each
RANDOM_MINUTES = 32
FUZZED = ("snapshot", "shape", "round_trip", "basis", "messages", "vestibule", "token", "session", "scene", "lua", "http")
FUZZ_SECONDS = 600  # of each target


def release_build(*targets):
    return [["sh", "docker/packages.sh", "server", "web", "test", "python", "lab"], ["cmake", "--preset", "release"],
            ["cmake", "--build", "--preset", "release", "--target", *targets]]


def build_for_arm(compiler, target):
    folder = f"build/arm64-{compiler}"
    return [["sh", "docker/packages.sh", "server", "test", "arm"], ["sh", "docker/arm64_sysroot.sh"],
            ["cmake", "--preset", "arm64", "-B", folder, f"-DCMAKE_CXX_COMPILER={compiler}"],
            ["cmake", "--build", folder, "--target", target]]


def list_jobs():
    """(name, minutes, commands) of all jobs; a command is an argument list, or that and its environment."""
    jobs = []

    def add_report(name, minutes, *words):
        jobs.append((f"lab_{name}", minutes, release_build("wobble_lab", "wobbled") + [
            ["build/release/bin/wobble_lab", *words, "--json", str(LOGS / f"{name}_figures.json")]]))

    for report, minutes in REPORTS.items():
        add_report(report, minutes, report)
    for part, minutes in STABILITY.items():
        add_report(f"stability_{part}", minutes, "stability", "--part", part)
    for seed in RANDOM_SEEDS:
        add_report(f"stability_random_{seed}", RANDOM_MINUTES, "stability", "--part", "random", "--seed", str(seed))
    for target in FUZZED:
        corpus = LOGS / f"corpus_{target}"
        jobs.append((f"fuzz_{target}", 1 + FUZZ_SECONDS / 60, [
            ["sh", "docker/packages.sh", "server", "test"], ["cmake", "--preset", "fuzz"],
            ["cmake", "--build", "--preset", "fuzz", "--target", f"fuzz_{target}"],
            ["mkdir", "-p", str(corpus)],
            [f"build/fuzz/tests/fuzz/fuzz_{target}", f"-max_total_time={FUZZ_SECONDS}", "-print_final_stats=1",
             f"-artifact_prefix={LOGS}/", str(corpus), f"tests/fuzz/corpus/{target}"]]))
    jobs.append(("soak_ten_minutes", 6, release_build("soak_test") + [
        (["build/release/tests/soak_test", "--gtest_filter=Soak.*"], {"WOBBLE_SOAK_SECONDS": "600"})]))
    jobs.append(("attacks", 2, release_build("attack_test", "programs") + [
        (["build/release/tests/attack_test"], {"WOBBLE_ATTACK_SECONDS": "20"})]))
    jobs.append(("ten_thousand_joins", 32, release_build("programs") + [
        (["bash", "tests/net/programs_test.sh", "joins_over_loss", "build/release/bin"],
         {"WOBBLE_JOIN_SECONDS": "1800", "WOBBLE_JOIN_BOTS": "48", "WOBBLE_JOINS": "10000", "WOBBLE_ADMIT_WHEN_BUSY": "1",
          "WOBBLE_CACHE": "build/release/tests/bases"})]))
    jobs.append(("kill_nine_200_times", 45, release_build("programs") + [
        ["python3", "tests/net/kill_test.py", "build/release/bin", "build/release/tests/bases", "--kills", "200", "--bots",
         "32"]]))
    jobs.append(("captures_of_all_scenes", 9, release_build("captures_test", "programs") + [
        ["build/release/tests/captures_test"], ["node", "tests/web/browser_pictures_test.mjs"],
        ["node", "tests/web/states_pictures.mjs"]]))
    # `make test` has the libraries' unit tests, the corpora and the golden scenes under these sanitizers; here is all else:
    # the programs, the gateway, the soak, every test of the engine. In a folder of its own: the option would stay in the
    # cache of build/asan, and `make test` would miss the programs that it does not build.
    everything = "build/sanitized"
    jobs.append(("sanitized_everything", 20, [
        ["sh", "docker/packages.sh", "server", "test"], ["cmake", "--preset", "asan", "-B", everything, "-DWOBBLE_SANITIZE_ALL=ON"],
        ["cmake", "--build", everything],
        (["ctest", "--test-dir", everything, "--output-on-failure", "-j9"], {"ASAN_SYMBOLIZER_PATH": "/usr/bin/llvm-symbolizer"})]))
    jobs.append(("races", 5, [
        ["sh", "docker/packages.sh", "server", "test"], ["cmake", "--preset", "tsan"],
        ["cmake", "--build", "--preset", "tsan", "--target", "threads_test", "golden_test"],
        ["ctest", "--preset", "tsan", "-R", "determinism|threads_test"]]))
    # The golden scenes, recordings and bytes by 64-bit ARM, emulated, of both compilers.
    for compiler in ("aarch64-linux-gnu-g++", "clang++-19"):
        jobs.append((f"arm64_{compiler}", 20, build_for_arm(compiler, "emulated_tests") + [
            ["ctest", "--test-dir", f"build/arm64-{compiler}", "--output-on-failure", "-j9", "-R",
             "determinism|Golden|CrowdEncoder|ModeSums"]]))
    gcc = "aarch64-linux-gnu-g++"
    jobs.append(("arm64_packages", 10, release_build("wobbled", "wobble") + build_for_arm(gcc, "programs") + [
        ["bash", "tests/install/arm64_test.sh", f"build/arm64-{gcc}", "build/release"]]))
    return jobs


def deal_out(jobs, parts):
    """For each part its jobs."""
    dealt = [[] for _ in range(parts)]
    for job in sorted(jobs, key=lambda each: -each[1]):
        min(dealt, key=lambda part: sum(each[1] for each in part)).append(job)
    return dealt


def read_commit():
    return subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def read_processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown"


def has_passed(result_file, commit):
    try:
        result = json.loads(result_file.read_text())
    except (OSError, ValueError):
        return False
    return result.get("commit") == commit and result.get("exit_code") == 0


def run_commands(commands, log):
    for command in commands:
        arguments, environment = command if isinstance(command, tuple) else (command, {})
        log.write("$ " + " ".join(arguments) + "\n")
        log.flush()
        code = subprocess.run(arguments, cwd=ROOT, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                              env={**os.environ, **environment}, check=False).returncode
        if code != 0:
            return code
    return 0


def run_job(name, commands, commit):
    """The exit code. The result file is written beside and renamed, so that an interrupted job has none."""
    begin = time.monotonic()
    with open(LOGS / f"{name}.log", "w", encoding="utf-8") as log:
        code = run_commands(commands, log)
    result = {"commit": commit, "cpu": read_processor(), "minutes": round((time.monotonic() - begin) / 60, 1),
              "exit_code": code}
    figures = LOGS / f"{name.removeprefix('lab_')}_figures.json"
    if name.startswith("lab_") and figures.exists():
        result["summary"] = json.loads(figures.read_text()).get("summary", {})
    unfinished = RESULTS / f".{name}.json"
    unfinished.write_text(json.dumps(result, indent=2) + "\n")
    unfinished.rename(RESULTS / f"{name}.json")
    return code


def run_part(part):
    RESULTS.mkdir(parents=True, exist_ok=True)
    LOGS.mkdir(parents=True, exist_ok=True)
    commit = read_commit()
    failed = []
    left = sum(minutes for _, minutes, _ in part)
    for name, minutes, commands in part:
        if has_passed(RESULTS / f"{name}.json", commit):
            print(f"{name}: has passed at this commit", flush=True)
        else:
            print(f"{name}: about {minutes:.0f} minutes of {left:.0f} left", flush=True)
            if run_job(name, commands, commit) != 0:
                failed.append(name)
                print(f"{name}: FAILED, see {(LOGS / name).relative_to(ROOT)}.log", flush=True)
        left -= minutes
    print(f"{len(part) - len(failed)} passed, {len(failed)} failed")
    return 1 if failed else 0


def complain(reason):
    print(f"nightly.py: {reason}", file=sys.stderr)
    return 2


def main(arguments):
    jobs = list_jobs()
    if len(arguments) == 2 and arguments[0] == "--list" and arguments[1].isdigit() and int(arguments[1]) > 0:
        for number, part in enumerate(deal_out(jobs, int(arguments[1])), start=1):
            print(f"part {number}: {sum(each[1] for each in part):.0f} minutes")
            for name, minutes, _ in part:
                print(f"  {minutes:4.0f}  {name}")
        return 0
    if len(arguments) != 1:
        return complain("PART is required, as in: make nightly PART=1/2")
    alone = [job for job in jobs if job[0] == arguments[0]]
    if alone:
        return run_part(alone)
    k, slash, n = arguments[0].partition("/")
    if not (slash and k.isdigit() and n.isdigit() and 1 <= int(k) <= int(n) <= len(jobs)):
        return complain(f"PART = {arguments[0]}: must be k/n with 1 <= k <= n <= {len(jobs)}, or a job, see --list")
    part = deal_out(jobs, int(n))[int(k) - 1]
    if sum(each[1] for each in part) > LONGEST_PART:
        return complain(f"PART = {arguments[0]}: this part takes longer than {LONGEST_PART} minutes; cut it finer")
    return run_part(part)


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit("nightly.py: interrupted; the same part goes on from here when it is run again")
