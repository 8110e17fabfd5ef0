# SPDX-License-Identifier: Apache-2.0
"""Promises about the sources that a machine can check: licence lines, citations, file sizes."""
import pathlib
import re
import subprocess
import sys

HARD_LIMIT = 600  # lines of a C++ file
bad = []
files = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True).stdout.split("\n")
code = [f for f in files if re.search(r"\.(hpp|cpp|cu|cuh|py|sh|cmake)$", f) or f.endswith("CMakeLists.txt")]
for name in code:
    text = pathlib.Path(name).read_text()
    if "SPDX-License-Identifier: Apache-2.0" not in text[:200]:
        bad.append(f"{name}: no SPDX licence line")
    if re.search(r"\.(hpp|cpp|cu|cuh)$", name) and text.count("\n") > HARD_LIMIT:
        bad.append(f"{name}: {text.count(chr(10))} lines, at most {HARD_LIMIT}")

bib = pathlib.Path("docs/references.bib")
keys = set(re.findall(r"^@\w+\{(\w+),", bib.read_text(), re.M)) if bib.exists() else set()
for name in code + [f for f in files if f.endswith(".md")]:
    if not name.startswith(("src/", "include/", "docs/")):
        continue
    for key in re.findall(r"\[([A-Z][A-Za-z]+\d{4})\]", pathlib.Path(name).read_text()):
        if key not in keys:
            bad.append(f"{name}: citation [{key}] is not in docs/references.bib")
print("\n".join(sorted(set(bad))) or "repo: ok")
sys.exit(bool(bad))
