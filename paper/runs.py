# SPDX-License-Identifier: Apache-2.0
"""Runs scenes through the program and reads what it says of them: counts, phases, how it ended."""
import concurrent.futures
import csv
import dataclasses
import functools
import hashlib
import json
import os
import pathlib
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHARED = pathlib.Path(os.environ.get("NOLI_SHARED_DIR", ROOT.parent / "shared")) / "ipc-scenes"
PHASES = ("t_pairs", "t_assemble", "t_solve", "t_ccd", "t_search", "t_output", "t_elastic", "t_barrier",
          "t_friction")


@dataclasses.dataclass
class Run:
    """One finished run. steps counts converged steps; ended is "" or how and where it ended early."""
    name: str
    steps: int
    newton: int
    pcg: int
    contacts: int
    min_gap: float
    wall_s: float
    ended: str
    limiting: str
    phases: dict
    rows: list

    @property
    def complete(self):
        return not self.ended

    def count(self):
        """Newton iterations as a table cell."""
        return str(self.newton) if self.complete else f"{self.ended} ({self.newton})"


def script_scene(path, noli):
    """The native form of an IPC script, or None where the shared scenes are missing."""
    source = SHARED / path
    if not source.exists():
        return None
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "scene.json"
        subprocess.run([noli, "convert", source, "-o", file], capture_output=True, check=True)
        scene = json.loads(file.read_text())
        return with_absolute_files(scene, pathlib.Path(folder))


def with_absolute_files(scene, folder):
    """The scene with its mesh files found from `folder`, so that it can be run from anywhere."""
    if isinstance(scene, list):
        return [with_absolute_files(item, folder) for item in scene]
    if not isinstance(scene, dict):
        return scene
    return {key: str((folder / value).resolve()) if key == "file" else with_absolute_files(value, folder)
            for key, value in scene.items()}


def merged(scene, changes):
    """scene with `changes` laid over it, object by object; a value of None removes a key."""
    out = dict(scene)
    for key, value in changes.items():
        if value is None:
            out.pop(key, None)
        elif isinstance(value, dict):
            out[key] = merged(out.get(key, {}), value)
        else:
            out[key] = value
    return out


# How the supplement's program minimises: from where the bodies are, every elastic Hessian projected,
# friction lagged once, and a test on the direction alone, at its default tolerance.
PAPER_METHOD = {"contact": {"friction_iterations": 1, "friction_hessian": "newton"},
                "solver": {"tolerance": 1e-2, "gap_tolerance": 0, "projection": "always", "start": "last"}}


def as_in_paper(scene):
    """The scene, minimised as the supplement's program does; what the scene says itself counts."""
    return merged(PAPER_METHOD, scene)


def run(noli, scene, name, folder, steps, timeout, threads=1, options=()):
    """Runs `steps` steps of a scene (a dict) under folder/name. With NOLI_KEEP_RUNS=1 a run that is there
    already, of the same scene by the same program, is read instead: hours of runs can be done in parts."""
    folder = pathlib.Path(folder) / name
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "scene.json"
    stats = folder / "run" / "stats.csv"
    identity = {"program": hash_of(noli), "scene": scene, "steps": steps, "threads": threads,
                "timeout": timeout, "options": list(options)}
    before = finished_before(folder / "done.json", identity)
    if before is not None:
        return read_run(name, folder, stats, before["code"], steps)
    file.write_text(json.dumps(scene))
    for old in (stats, folder / "done.json"):
        old.unlink(missing_ok=True)
    command = [noli, "run", file, "-o", folder / "run", "--overwrite", "--frames-every", "0",
               "--steps", str(steps), "--threads", str(threads), *options]
    with open(folder / "log.txt", "w") as log:
        try:
            code = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT,
                                  timeout=timeout).returncode
        except subprocess.TimeoutExpired:
            code = None
    done = read_run(name, folder, stats, code, steps)
    (folder / "done.json").write_text(json.dumps({**identity, "code": code}))
    return done


@functools.cache
def hash_of(program):
    return hashlib.sha256(pathlib.Path(program).read_bytes()).hexdigest()


def finished_before(file, identity):
    """What done.json says of an earlier run if it is the same run and may be kept, or None."""
    if os.environ.get("NOLI_KEEP_RUNS") != "1" or not file.exists():
        return None
    before = json.loads(file.read_text())
    same = all(before.get(key) == json.loads(json.dumps(value)) for key, value in identity.items())
    return before if same else None


def record(folder):
    """run.json of a run made by run() in `folder`."""
    return json.loads((pathlib.Path(folder) / "run/run.json").read_text())


def read_run(name, folder, stats, code, steps):
    rows = list(csv.DictReader(open(stats))) if stats.exists() else []
    log = (folder / "log.txt").read_text()
    good = sum(row["outcome"] == "converged" for row in rows)
    ended = ""
    if code is None:
        ended = f"time@{good + 1}"
    elif code not in (0, 3):
        raise RuntimeError(f"{name}: exit code {code}\n{log[-2000:]}")
    elif good < steps:
        last = rows[-1]["outcome"] if rows and rows[-1]["outcome"] != "converged" else "ended"
        ended = f"{last}@{good + 1}"
    limiting = re.search(r"limited by (.*?), smallest gap", log)
    gaps = [float(row["min_gap"]) for row in rows if row["min_gap"] not in ("", "inf")]
    return Run(name=name, steps=good, newton=sum(int(row["newton"]) for row in rows),
               pcg=sum(int(row["pcg"]) for row in rows),
               contacts=max((int(row["contacts"]) for row in rows), default=0),
               min_gap=min(gaps, default=float("inf")),
               wall_s=sum(float(row["wall_s"]) for row in rows), ended=ended,
               limiting=limiting.group(1) if limiting else "",
               phases={phase: sum(float(row[phase]) for row in rows) for phase in PHASES},
               rows=rows)


def run_all(jobs, workers):
    """Calls each job (a function without arguments) on `workers` threads; results in order."""
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        return [future.result() for future in [pool.submit(job) for job in jobs]]
