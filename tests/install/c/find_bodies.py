#!/usr/bin/env python3
"""Finds what client/example.c draws in the last of the pictures (BMP, 24 bits) that are named.

Exit code 0: the own body, orange (no blue), and others, blue, have at least 100 pixels each.
"""
import sys
from pathlib import Path

pixels = Path(sorted(sys.argv[1:])[-1]).read_bytes()[54:]
blues = pixels[0 : len(pixels) - 2 : 3]  # blue, green, red
own, others = blues.count(0), sum(blue > 100 for blue in blues)
print(f"{own} pixels of the own body, {others} of others")
sys.exit(0 if min(own, others) >= 100 else 1)
