#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Where nvcc is missing, makes a CUDA toolkit in build/cuda-toolkit from the Python wheels of its parts: what
# compiles and links the CUDA engine, without a driver, a debugger or other libraries. CMake looks there.
#
#     tools/cuda_toolkit.sh          unless there is an nvcc; says in one line where the toolkit is
#     tools/cuda_toolkit.sh FOLDER   in FOLDER, also beside an nvcc
#
# Needs Python 3 with pip (PYTHON names another one), g++, and the network the first time; about 300 MB of disk.
# Ends with 1 and the error where the wheels cannot be had or do not make a working compiler.
set -euo pipefail
folder=build/cuda-toolkit
[ $# -eq 0 ] || folder=$(realpath -m "$1")
cd "$(dirname "$0")/.."

# One release, CUDA 13.0 update 2. Another one needs new figures in docs/performance.md (registers, spills).
wheels=(
    nvidia-cuda-nvcc==13.0.88      # nvcc, cudafe++, ptxas, fatbinary, nvlink
    nvidia-cuda-crt==13.0.88       # headers that nvcc includes by itself
    nvidia-nvvm==13.0.88           # cicc, libdevice
    nvidia-cuda-runtime==13.0.96   # cuda_runtime.h, libcudart
    nvidia-cuda-cccl==13.0.85      # CUB
)
stamp=$(printf '%s\n' "${wheels[@]}")
say() { echo "cuda-toolkit: $*"; }
give_up() {
    say "FAILED: $1" >&2
    [ ! -s "$scratch/log" ] || tail -n 20 "$scratch/log" >&2
    exit 1
}

if [ $# -eq 0 ]; then
    named=${CUDACXX:-}  # it may hold options
    for nvcc in "${named%% *}" nvcc /usr/local/cuda/bin/nvcc; do
        if command -v -- "$nvcc" >/dev/null; then say "$(command -v -- "$nvcc") is installed"; exit 0; fi
    done
fi
if [ "$(cat "$folder/stamp" 2>/dev/null)" = "$stamp" ]; then say "$folder"; exit 0; fi

mkdir -p "$(dirname "$folder")"
scratch=$(mktemp -d "$folder.XXXXXX")
trap 'rm -rf "$scratch"' EXIT

# The first Python that has pip: the distribution's often has none, or the one before it on the search path.
python=""
for candidate in ${PYTHON:-python3 /usr/bin/python3}; do
    if "$candidate" -m pip --version >"$scratch/log" 2>&1; then python=$candidate; break; fi
done
[ -n "$python" ] || give_up "no Python with pip (Debian package python3-pip; PYTHON names another Python)"

PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore "$python" -m pip install --quiet --no-deps --no-compile \
    --only-binary=:all: --target "$scratch/wheels" "${wheels[@]}" >"$scratch/log" 2>&1 ||
    give_up "pip did not install ${wheels[*]}:"

# The layout of an installed toolkit. The wheels' libraries have no name to link against but the static ones.
mkdir "$scratch/toolkit"
mv "$scratch"/wheels/nvidia/cu*/* "$scratch"/wheels/*.dist-info "$scratch/toolkit" 2>"$scratch/log" ||
    give_up "the wheels do not have their parts in nvidia/cu*:"
ln -sfn lib "$scratch/toolkit/lib64"
(cd "$scratch/toolkit/lib" && for library in *.so.*; do ln -sf "$library" "${library%.so.*}.so"; done)

# A kernel with a function of libdevice and a header of CUB, linked and started: needs every part, but no GPU.
cat >"$scratch/check.cu" <<'CODE'
#include <cub/version.cuh>
#include <cstdio>
__global__ void exponentials(double* x) { x[threadIdx.x] = exp(x[threadIdx.x]); }
int main(int argc, char**) {
    if (argc > 1) exponentials<<<1, 1>>>(nullptr);
    int version = 0;
    if (cudaRuntimeGetVersion(&version) != cudaSuccess) return 1;
    std::printf("%d\n", version);
}
CODE
"$scratch/toolkit/bin/nvcc" -std=c++20 -arch=sm_80 -o "$scratch/check" "$scratch/check.cu" >"$scratch/log" 2>&1 ||
    give_up "nvcc of ${wheels[*]} does not compile and link a small kernel:"
version=$("$scratch/check" 2>"$scratch/log") || give_up "a program of nvcc of ${wheels[*]} does not start:"

echo "$stamp" >"$scratch/toolkit/stamp"
rm -rf "$folder"
mv "$scratch/toolkit" "$folder"
say "$folder (made from wheels, CUDA runtime $version)"
