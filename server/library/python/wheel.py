#!/usr/bin/env python3
"""Packs a wheel (PEP 427) from an installed copy of the module, with Python's standard library alone.

    wheel.py PACKAGE VERSION LICENSE FOLDER    (PACKAGE: .../wobble; writes FOLDER/wobble-VERSION-*.whl)

The same files give the same bytes.
"""

import base64
import hashlib
import sys
import sysconfig
import zipfile
from pathlib import Path

package, version, license_file, folder = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]), Path(sys.argv[4])
python = f"cp{sys.version_info.major}{sys.version_info.minor}"
tag = f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
info = f"wobble-{version}.dist-info"
files = {str(file.relative_to(package.parent)): file.read_bytes() for file in sorted(package.rglob("*")) if file.is_file()}
files[f"{info}/LICENSE"] = license_file.read_bytes()
files[f"{info}/METADATA"] = f"""Metadata-Version: 2.1
Name: wobble
Version: {version}
Summary: Worlds of soft bodies: simulation, recordings, and a client of servers
License: MIT
Requires-Python: >={sys.version_info.major}.{sys.version_info.minor}
Requires-Dist: numpy
Description-Content-Type: text/markdown

{(package / "README.md").read_text()}""".encode()
files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: wobble\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
record = []
for name, content in files.items():
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    record.append(f"{name},sha256={digest},{len(content)}\n")
files[f"{info}/RECORD"] = "".join(record + [f"{info}/RECORD,,\n"]).encode()

folder.mkdir(parents=True, exist_ok=True)
for old in folder.glob("wobble-*.whl"):
    old.unlink()
with zipfile.ZipFile(folder / f"wobble-{version}-{tag}.whl", "w", zipfile.ZIP_DEFLATED) as wheel:
    for name, content in files.items():
        entry = zipfile.ZipInfo(name)  # of 1980, whenever it is packed
        entry.compress_type = zipfile.ZIP_DEFLATED
        entry.external_attr = (0o755 if ".so" in name else 0o644) << 16
        wheel.writestr(entry, content)
print(folder / f"wobble-{version}-{tag}.whl")
