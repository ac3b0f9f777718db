#!/usr/bin/env python3
"""Checks every document (*.md) of the repository against the files that it describes.

    documents_test.py ROOT [BIN]

1. A code block in C, C++, C#, GDScript, TOML, Lua, JavaScript or Python equals the file that it shows. The line before
   its fence names the file:
       <!-- from: client/example.cpp -->              the whole file
       <!-- from: PATH#first text..last text -->      its lines from the first that holds `first text` to the next
                                                      that holds `last text`, both included
   A block of these languages without such a line is a fault.
2. Every relative link and picture leads to a file, and every anchor to a heading.
3. README.md has at most 200 lines.
4. Every option of wobbled, wobble and wobble_lab that a document names stands in the sources.
5. With BIN, the folder of the programs: wobbled hosts each scene of server/scenes/examples.

Prints one line a fault, with file and line. Exit code 1 when there is one.
"""
import re
import subprocess
import sys
from pathlib import Path

MOST_README_LINES = 200
CHECKED_LANGUAGES = {"c", "cpp", "csharp", "gdscript", "toml", "lua", "js", "python"}
SKIPPED_FOLDERS = {"build", "node_modules"}
# Options of other programs that documents name in a code span without their program.
FOREIGN_OPTIONS = {"--cpuset-cpus", "--cpus", "--network", "--no-cache", "--volume", "--write", "--component", "--file"}
# A call of one of our programs, with its options up to the end of the command.
OUR_CALL = re.compile(r"(?:wobbled|wobble (?:play|host|watch|export|bots|gateway|link|health)|wobble_lab \w+)\b([^|&;#]*)")
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*")
LINK = re.compile(r"\[(?:[^\[\]]|\[[^\]]*\])*\]\(([^)\s]+)\)")
SOURCE = re.compile(r"<!-- from: ([^#]+?)(?:#(.+)\.\.(.+))? -->$")

faults = []


def report(path, number, what):
    faults.append(f"{path.relative_to(root)}:{number}: {what}")


def split(path):
    """Returns the lines of prose as (number, text), the code blocks as (number, language, text, line before)."""
    prose, blocks, block, before = [], [], None, ""
    for number, line in enumerate(path.read_text().split("\n"), 1):
        if line.startswith("```"):
            if block is None:
                block = [number, line[3:].strip(), [], before]
            else:
                blocks.append((block[0], block[1], "\n".join(block[2]), block[3]))
                block = None
        elif block is not None:
            block[2].append(line)
        else:
            prose.append((number, line))
        before = line
    if block is not None:
        report(path, block[0], "a code block has no end")
    return prose, blocks


def read_shown(name, first, last):
    """The text that a mark names; None where there is no such text."""
    if not (root / name).is_file():
        return None
    lines = (root / name).read_text().rstrip("\n").split("\n")
    if first is None:
        return "\n".join(lines)
    begin = next((i for i, line in enumerate(lines) if first in line), None)
    end = next((i for i, line in enumerate(lines) if begin is not None and i >= begin and last in line), None)
    return None if end is None else "\n".join(lines[begin : end + 1])


def check_block(path, number, language, text, before):
    if language not in CHECKED_LANGUAGES:
        return
    mark = SOURCE.match(before)
    if mark is None:
        return report(path, number, f"the line before a block in {language} must be <!-- from: FILE -->")
    shown = read_shown(*mark.groups())
    if shown is None:
        report(path, number, f"{mark.group(0)} names no text")
    elif shown != text:
        report(path, number, f"the block differs from {mark.group(1)}")


def list_anchors(path):
    """Anchors of the headings, as GitHub makes them."""
    anchors = []
    for heading in (re.match(r"#{1,6} (.*)", line) for _, line in split(path)[0]):
        if heading is not None:
            text = re.sub(r"\]\([^)]*\)", "", heading.group(1)).strip().lower()
            anchor = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
            anchors.append(f"{anchor}-{anchors.count(anchor)}" if anchor in anchors else anchor)
    return anchors


def check_links(path, number, line):
    for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (path.parent / name).resolve() if name else path
        if not file.exists():
            report(path, number, f"{target} leads to no file")
        elif anchor and file.suffix == ".md" and anchor not in list_anchors(file):
            report(path, number, f"{target} leads to no heading")


def check_options(path, number, text, sources):
    named = {option for call in OUR_CALL.findall(text) for option in OPTION.findall(call)}
    for option in sorted(named - FOREIGN_OPTIONS):
        if not re.search(rf'"{option}["=, ]', sources):
            report(path, number, f"{option} stands in no source")


def check_document(path, sources):
    prose, blocks = split(path)
    for number, line in prose:
        check_links(path, number, line)
        for span in re.findall(r"`([^`]+)`", line):
            check_options(path, number, ("wobbled " if span.startswith("--") else "") + span, sources)
    for number, language, text, before in blocks:
        check_block(path, number, language, text, before)
        for line in text.replace("\\\n", " ").split("\n"):
            check_options(path, number, line, sources)


def host_examples(programs):
    for scene in sorted((root / "server/scenes/examples").glob("*.toml")):
        command = [programs / "wobbled", "--scene", scene, "--for", "0.2", "--port", "0", "--untrained"]
        result = subprocess.run(command, capture_output=True, text=True, timeout=60)
        if result.returncode != 0:
            report(scene, 1, f"wobbled refuses it: {result.stderr.strip()}")


root = Path(sys.argv[1]).resolve()
files = [p for folder in ("server", "client", "tests/bench") for p in (root / folder).rglob("*.cpp")]
all_sources = "\n".join(p.read_text() for p in files if "node_modules" not in p.parts) + '"--help" "--version"'
documents = sorted(p for p in root.rglob("*.md") if not SKIPPED_FOLDERS & set(p.relative_to(root).parts))
for document in documents:
    check_document(document, all_sources)
readme_lines = (root / "README.md").read_text().count("\n")
if readme_lines > MOST_README_LINES:
    report(root / "README.md", readme_lines, f"{readme_lines} lines; at most {MOST_README_LINES}")
if len(sys.argv) > 2:
    host_examples(Path(sys.argv[2]).resolve())
print("\n".join(faults) if faults else f"{len(documents)} documents agree with their files")
sys.exit(1 if faults else 0)
