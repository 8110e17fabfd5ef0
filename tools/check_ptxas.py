#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Registers, stack and spills of the CUDA kernels, from what ptxas said when they were compiled.

    tools/check_ptxas.py build/cuda          the .ptxas files that the build left (tools/ptxas_launcher.sh)
    tools/check_ptxas.py FILE.ptxas          one of them
    tools/check_ptxas.py --markdown ...      the table as docs/performance.md has it

Fails if a hot kernel spills, or a function that it calls. Fails also if a hot kernel is missing, so that a
renamed one does not escape.
"""
import argparse
import pathlib
import re
import subprocess
import sys

# Kernel (the function whose loop it is, see for_each in the sources) -> what it is in the table. "Doubles 1" is
# Doubles::Only: loops free of exact stages (geometry/stages.hpp), which those of Doubles::First, with such
# stages, redo where next to never doubles do not suffice.
HOT = {
    "TetEnergyKernel": "elastic energy",
    "TetGradientKernel": "elastic gradient",
    "TetHessianKernel": "elastic gradient and projected Hessian",
    "assemble_blocks": "block assembly",
    "GuardedProductKernel": "block product",
    "BlockProductKernel": "block product (outside of PCG)",
    "mode_forces": "contact product",
    "gather_slots": "contact product, gather",
    "device_curvature": "PCG, p.Ap",
    "device_update": "PCG, step and block Jacobi",
    "device_advance": "PCG, step",
    "device_combine": "PCG, preconditioner sum",
    "device_direction": "PCG, direction",
    "restrict_to_nodes": "rigid motions, restriction",
    "apply_inverse": "rigid motions, dense inverse",
    "coarse_rows": "rigid motions, coarse matrix",
    "eliminate_pivot": "dense inverses, update",
    "pivot_panels": "dense inverses, pivot",
    "apply_banks": "Schwarz banks",
    "fill_pair_terms ContactHessian 0 Doubles 1": "barrier terms, gn",
    "fill_pair_terms ContactHessian 1 Doubles 1": "barrier terms, gn+ (3, numeric, is for comparison, not hot)",
    "fill_pair_terms ContactHessian 2 Doubles 1": "barrier terms, exact",
    "fill_mollified_terms MollifiedHessian 0 Doubles 1": "mollified terms, two_mode",
    "fill_mollified_terms MollifiedHessian 1 Doubles 1": "mollified terms, four_mode",
    "fill_mollified_terms MollifiedHessian 2 Doubles 1": "mollified terms, exact",
    "fill_wall_terms": "half-space terms",
    "fill_friction_terms": "friction terms",
    "pair_energy_sum Doubles 1": "barrier energy",
    "mollified_energy_sum Doubles 1": "mollified energy",
    "friction_energy_sum": "friction energy",
    "classify_candidates Doubles 1": "pair classification",
    "pair_distances Doubles 1": "pair distances",
    "advance_list Limit 1 Doubles 1": "continuous collision detection, vertex-triangle",
    "advance_list Limit 2 Doubles 1": "continuous collision detection, edge-edge",
    "advance_list Limit 3 Doubles 1": "continuous collision detection, half-space",
    "search_groups": "tree traversal",
    "compact_groups": "tree traversal, second pass",
    "primitive_boxes": "tree refit",
    "merge_level": "tree refit, upper levels",
}

ENTRY = re.compile(r"Compiling entry function '(.*)' for '(sm_\d+)'")
PROPERTIES = re.compile(r"Function properties for (.*)")
FRAME = re.compile(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads")
USED = re.compile(r"Used (\d+) registers")


def demangle(text):
    try:
        return subprocess.run(["c++filt"], input=text, capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        sys.exit("check_ptxas: needs c++filt (package binutils)")


def files_of(paths):
    for path in map(pathlib.Path, paths):
        found = sorted(path.rglob("*.ptxas")) if path.is_dir() else [path]
        if not found:
            sys.exit(f"check_ptxas: no .ptxas file in {path}; build the preset \"cuda\" first")
        yield from found


class Kernel:
    """What ptxas said of one kernel and of the functions that it calls."""

    def __init__(self, name, arch):
        self.name, self.arch, self.registers = name, arch, 0
        self.stack = self.stores = self.loads = 0
        self.callees = {}  # name -> (stores, loads), where not 0

    def key(self):
        return (self.name, self.arch)


def short_name(entry):
    """The function whose loop a kernel is: what stands before the lambda, or the functor's name. Where the
    function is made for values of enumerations, their names and numbers follow."""
    functors = [word for word in re.findall(r"noli::(?:detail::)?(\w+Kernel)\b", entry)]
    if functors:
        return functors[0]
    before = entry.split("::{lambda", 1)[0] if "::{lambda" in entry else entry
    # noli::detail::run_kernel<noli::detail::trial_point<...>(...)
    inner = before.split("_kernel<", 1)[-1]
    inner = re.sub(r"^noli::detail::(?:Add|Smaller), ", "", inner)
    inner = re.sub(r"^noli::detail::Negated<", "", inner)
    name = re.match(r"(?:void )?(?:\w+::)*(\w+)(<(?:\((?:\w+::)*\w+\)\d+(?:, )?)+)?", inner)
    if not name:
        return entry[:40]
    values = re.findall(r"(\w+)\)(\d+)", name.group(2) or "")
    return " ".join([name.group(1), *(f"{kind} {value}" for kind, value in values)])


def callee_name(function):
    """The name of a function that kernels call; of one with exact stages also the body that it runs."""
    body = re.search(r"::exactly<(?:\w+::)*(\w+)", function)
    return f"exactly {body.group(1)}" if body else re.sub(r"\(.*", "", function).split("::")[-1]


def parse(text):
    kernels, kernel, function = [], None, None
    for line in demangle(text).splitlines():
        if found := ENTRY.search(line):
            kernel = Kernel(found.group(1), found.group(2))
            kernels.append(kernel)
            function = None
        elif found := PROPERTIES.search(line):
            function = found.group(1)
        elif (found := FRAME.search(line)) and kernel:
            stack, stores, loads = map(int, found.groups())
            if function and function != kernel.name:
                if stores or loads:
                    kernel.callees[callee_name(function)] = (stores, loads)
            else:
                kernel.stack, kernel.stores, kernel.loads = stack, stores, loads
        elif (found := USED.search(line)) and kernel:
            kernel.registers = int(found.group(1))
            if stack := re.search(r"(\d+) bytes cumulative stack", line):
                kernel.stack = int(stack.group(1))
    return kernels


def rows_of(kernels):
    """Worst instance per (short name, architecture)."""
    worst = {}
    for kernel in kernels:
        key = (short_name(kernel.name), kernel.arch)
        old = worst.get(key)
        if old is None or (kernel.stores, kernel.registers, kernel.stack) > (old.stores, old.registers, old.stack):
            worst[key] = kernel
    return worst


def print_table(worst, hot_only, markdown):
    line = "| {} | {} | {} | {} | {} | {} |" if markdown else "{:40} {:6} {:>9} {:>7} {:>13}  {}"
    print(line.format("kernel", "arch", "registers", "stack", "spill st/ld", "called functions that spill"))
    if markdown:
        print("| --- | --- | --- | --- | --- | --- |")
    for (name, arch), kernel in sorted(worst.items()):
        if hot_only and name not in HOT:
            continue
        callees = ", ".join(f"{c} {s}/{l}" for c, (s, l) in sorted(kernel.callees.items()))
        print(line.format(name, arch, kernel.registers, kernel.stack, f"{kernel.stores}/{kernel.loads}", callees))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="+")
    parser.add_argument("--all", action="store_true", help="list every kernel, not the hot ones alone")
    parser.add_argument("--markdown", action="store_true")
    arguments = parser.parse_args()
    kernels = []
    for path in files_of(arguments.paths):
        kernels += parse(path.read_text(errors="replace"))
    kernels = [k for k in kernels if "noli::" in k.name and not k.name.startswith("void cub::")]
    worst = rows_of(kernels)
    print_table(worst, not arguments.all, arguments.markdown)

    bad = []
    for name in HOT:
        if not any(key[0] == name for key in worst):
            bad.append(f"{name}: not among the kernels; renamed? (HOT in tools/check_ptxas.py)")
    for (name, arch), kernel in sorted(worst.items()):
        if name not in HOT:
            continue
        if kernel.stores or kernel.loads:
            bad.append(f"{name} ({arch}) spills {kernel.stores}/{kernel.loads} bytes")
    for name, arch, stores, loads in sorted({(c, k.arch, s, l) for k in kernels for c, (s, l) in k.callees.items()
                                             if short_name(k.name) in HOT}):
        if stores or loads:
            bad.append(f"{name} ({arch}), called by a hot kernel, spills {stores}/{loads} bytes")
    for text in bad:
        print("check_ptxas:", text, file=sys.stderr)
    print(f"check_ptxas: {'FAILED' if bad else 'ok'}; {len(kernels)} kernels of noli, {len(HOT)} of them hot")
    return bool(bad)


if __name__ == "__main__":
    sys.exit(main())
