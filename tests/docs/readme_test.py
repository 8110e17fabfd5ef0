# SPDX-License-Identifier: Apache-2.0
"""Runs the first scene of README.md and every `noli` command beside it; checks links and make targets."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parents[2]
text = (root / "README.md").read_text()
failures = []


def block(language):
    found = re.findall(r"```" + language + r"\n(.*?)```", text, re.S)
    if not found:
        failures.append(f"README.md has no {language} block")
    return found


for target in re.findall(r"^make (\w+)$", "\n".join(block("")), re.M):
    if not re.search(rf"^{target}:", (root / "Makefile").read_text(), re.M):
        failures.append(f"Makefile has no target {target}")

for page in [root / "README.md", *sorted((root / "docs").glob("*.md"))]:
    for link in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
        if "://" not in link and not (page.parent / link).exists():
            failures.append(f"{page.name}: link to {link}, which is not there")

environment = dict(os.environ, PATH=f"{pathlib.Path(os.environ['NOLI_BINARY']).parent}:{os.environ['PATH']}")
with tempfile.TemporaryDirectory() as folder:
    (pathlib.Path(folder) / "ball.json").write_text(block("json")[0])
    commands = [line for line in "\n".join(block("sh")).split("\n") if line.strip()]
    for command in commands:
        done = subprocess.run(command, shell=True, cwd=folder, env=environment, capture_output=True, text=True)
        if done.returncode != 0:
            failures.append(f"`{command}` ended with {done.returncode}: {done.stderr.strip()}")
    if not (pathlib.Path(folder) / "out/frames.pvd").exists():
        failures.append("out/frames.pvd was not written")

print("\n".join(failures) or f"README: {len(commands)} commands and all links are fine")
sys.exit(bool(failures))
