# SPDX-License-Identifier: Apache-2.0
"""Fail when a file in src/ includes a room that its own room may not depend on."""
import pathlib, re, sys

ROOMS = {  # room: rooms it may include (itself and include/noli/ are always allowed)
    "core": [],
    "exec": ["core"],
    "geometry": ["core"],
    "energy": ["core", "geometry"],
    "mesh": ["core"],
    "scene": ["core", "mesh"],
    "model": ["core", "exec", "mesh", "geometry", "energy"],
    "contact": ["core", "exec", "geometry"],
    "linear": ["core", "exec"],
    "objective": ["core", "exec", "geometry", "energy", "model", "contact", "linear"],
    "step": ["core", "exec", "energy", "model", "contact", "objective", "linear"],
    "output": ["core"],
    "sim": ["core", "exec", "energy", "scene", "mesh", "model", "contact", "objective", "linear", "step", "output"],
}
INCLUDE = re.compile(r'^\s*#include\s+"(\w+)/', re.M)

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "src")
bad = []
for path in sorted(p for p in root.rglob("*") if p.suffix in {".hpp", ".cpp", ".cu", ".cuh"}):
    room = path.relative_to(root).parts[0]
    for target in INCLUDE.findall(path.read_text()):
        if target in ("noli", room) or target in ROOMS[room]:
            continue
        bad.append(f"{path}: room '{room}' may not include '{target}/'")
print("\n".join(bad) or "rooms: ok")
sys.exit(bool(bad))
