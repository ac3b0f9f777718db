"""Reads the numbers that protocol/STANDARD.md gives in its code blocks: the tables of the codec and the test vector.

The decoder takes them from the document instead of repeating them, so that a wrong number in the document shows as a
wrong hash. Each such block begins with ```text and its name.
"""

import pathlib
import re

FOLDER = pathlib.Path(__file__).resolve().parents[2] / 'protocol'


def read_blocks():
    """All named blocks of the document: name -> text."""
    text = (FOLDER / 'STANDARD.md').read_text(encoding='utf-8')
    return dict(re.findall(r'^```text ([\w-]+)\n(.*?)^```$', text, re.MULTILINE | re.DOTALL))


BLOCKS = read_blocks()


def read_numbers(name):
    """The integers of a block."""
    return [int(word) for word in BLOCKS[name].split()]


def read_rows(name):
    """The integers of a block whose lines begin with their own number and a colon."""
    return [[int(word) for word in line.split(':')[1].split()] for line in BLOCKS[name].splitlines()]


def read_bytes(name):
    """The bytes of a block of hexadecimal numbers."""
    return bytes.fromhex(BLOCKS[name])
