#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `make gpu-check`: builds for this machine's GPU, compares GPU with CPU, runs the scene tests and the
# sanitizers on it, and times it. Needs a CUDA toolkit, CMake 3.25, a C++20 compiler, and the libraries of
# tools/gpu_prefix.sh: installed, or unpacked somewhere that CMAKE_PREFIX_PATH names. No package manager,
# no network.
#
#     tools/gpu_check.sh                all of it
#     tools/gpu_check.sh --build-only   without a GPU too: configure and build
#     tools/gpu_check.sh --strict ...   take libraries from CMAKE_PREFIX_PATH alone
#
# Ends with 0 if all passed, 77 if there is no GPU, 2 if something to build with is missing, 1 otherwise.
# Results: out/gpu (log, gpu.csv, gpu.md). JOBS=n limits the build, BUILD=folder says where to.
set -uo pipefail
cd "$(dirname "$0")/.."
build_only=0
strict=0
for argument in "$@"; do
    case $argument in
        --build-only) build_only=1 ;;
        --strict) strict=1 ;;
        *) echo "gpu_check: unknown argument $argument" >&2; exit 2 ;;
    esac
done
build=${BUILD:-build/gpu}
out=out/gpu
jobs=${JOBS:-$(nproc 2>/dev/null || echo 2)}
say() { echo "gpu-check: $*"; }
give_up() { echo "gpu-check: $*" >&2; exit "${code:-1}"; }

# The architecture of the GPU, or nothing.
capability=""
if command -v nvidia-smi >/dev/null; then
    capability=$(nvidia-smi --query-gpu=compute_cap --format=csv,noheader 2>/dev/null | head -n 1 | tr -d '. ')
    [[ $capability =~ ^[0-9]+$ ]] || capability=""
fi
if [ -z "$capability" ] && [ $build_only -eq 0 ]; then
    code=77 give_up "no NVIDIA GPU on this machine (nvidia-smi lists none), so nothing was checked;" \
        "--build-only builds without one"
fi

# What to build with.
missing=()
command -v cmake >/dev/null || missing+=("cmake (3.25 or later)")
command -v "${CXX:-g++}" >/dev/null || missing+=("${CXX:-g++} (a C++20 compiler)")
nvcc=${CUDACXX:-$(command -v nvcc || true)}
for place in /usr/local/cuda "$PWD/build/cuda-toolkit"; do
    [ -n "$nvcc" ] || { [ -x "$place/bin/nvcc" ] && nvcc=$place/bin/nvcc; }
done
[ -n "$nvcc" ] && [ -x "$nvcc" ] || missing+=("nvcc (the CUDA toolkit; CUDACXX names it, tools/cuda_toolkit.sh makes one)")
command -v python3 >/dev/null || missing+=("python3")
generator="Unix Makefiles"
if command -v ninja >/dev/null; then generator=Ninja; elif ! command -v make >/dev/null; then missing+=("ninja or make"); fi
if [ ${#missing[@]} -gt 0 ]; then
    printf 'gpu-check: missing: %s\n' "${missing[@]}" >&2
    exit 2
fi

options=(-DCMAKE_BUILD_TYPE=Release -DNOLI_CUDA=ON -DNOLI_CHOLMOD=OFF
    "-DCMAKE_CUDA_ARCHITECTURES=${capability:-80-real;90}" "-DCMAKE_CUDA_COMPILER=$nvcc")
# Libraries that Debian keeps under its name of the architecture.
prefixes=${CMAKE_PREFIX_PATH:-}
for prefix in ${prefixes//[:;]/ }; do
    for folder in "$prefix"/lib/*-linux-gnu; do
        [ -d "$folder" ] && options+=("-DCMAKE_LIBRARY_ARCHITECTURE=$(basename "$folder")" "-DCMAKE_BUILD_RPATH=$folder")
    done
done
[ $strict -eq 1 ] && options+=(-DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF)
mkdir -p $out
say "configuring ($generator, ${capability:+GPU of compute capability $capability, }$nvcc)"
if ! cmake -S . -B "$build" -G "$generator" "${options[@]}" >$out/configure.log 2>&1; then
    cat $out/configure.log >&2
    code=2 give_up "the configuration failed: most likely a library is missing. tools/gpu_prefix.sh collects all of them" \
        "on a Debian machine; unpack its folder here and set CMAKE_PREFIX_PATH to it"
fi
say "building"
cmake --build "$build" -j "$jobs" --target noli_cli cuda_parity cuda_warp_product unit_sim scenes noli_bench_gpu \
    >$out/build.log 2>&1 || { tail -n 40 $out/build.log >&2; give_up "the build failed; all of it is in $out/build.log"; }
python3 tools/check_ptxas.py "$build/CMakeFiles/noli_sim.dir" >$out/ptxas.txt 2>&1 || say "ptxas: see $out/ptxas.txt"
if [ $build_only -eq 1 ] && [ -z "$capability" ]; then
    say "built in $build; not run, there is no GPU here"
    exit 0
fi

failed=()
check() {  # name command...
    local name=$1
    shift
    if "$@" >"$out/$name.log" 2>&1; then say "$name: passed"; else say "$name: FAILED, see $out/$name.log"; failed+=("$name"); fi
}
tests=$build/tests
check parity "$tests/cuda/cuda_parity"
check warp_product "$tests/cuda/cuda_warp_product"
check engine "$tests/unit_sim" --gtest_filter='Cuda*:Device*:Guarded*:LoopParity*'
check scenes env NOLI_TEST_DEVICE=cuda "$tests/scenes" --gtest_filter='-*Ipc*:*StateHash*'

# A skipped test is not a passed one.
if grep -q 'SKIPPED' $out/parity.log; then failed+=("parity (skipped)"); fi

sanitizer=$(command -v compute-sanitizer || ls "$(dirname "$nvcc")/compute-sanitizer" 2>/dev/null || true)
if [ -n "$sanitizer" ]; then
    for tool in memcheck racecheck; do
        check "$tool" "$sanitizer" --tool $tool --error-exitcode 1 "$tests/cuda/cuda_parity" \
            --gtest_filter='*EveryLoopMatchesTheCpu*:*StepsRepeatBitwise*'
    done
else
    say "no compute-sanitizer beside $nvcc"
    failed+=("sanitizers (missing)")
fi

say "timing"
python3 tools/gpu_bench.py --build "$build" --out $out || failed+=("benchmark")
[ ${#failed[@]} -eq 0 ] || give_up "failed: ${failed[*]}"
say "all passed; the table is $out/gpu.md, its numbers $out/gpu.csv"
