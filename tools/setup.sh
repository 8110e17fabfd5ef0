#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what the build needs on Debian and Ubuntu; elsewhere names what is missing.
set -euo pipefail

packages=(
    g++ cmake ninja-build git python3
    libtbb-dev nlohmann-json3-dev libcli11-dev libfmt-dev zlib1g-dev libxxhash-dev
    libtinyobjloader-dev libsuitesparse-dev libopenblas0-pthread libmetis-dev
    libgtest-dev libgmock-dev libbenchmark-dev libeigen3-dev python3-jsonschema
    clang-format-14 clang-tidy-14
)

# `setup.sh paper`: what the scripts in paper/ need besides.
if [ "${1:-}" = paper ]; then
    packages+=(python3-numpy python3-matplotlib python3-sympy python3-vtk9 xvfb xauth libgl1-mesa-dri)
fi

if ! command -v apt-get >/dev/null; then
    echo "setup: this system has no apt. Install the counterparts of these Debian packages yourself:"
    printf '  %s\n' "${packages[@]}"
    for tool in g++ cmake ninja python3; do
        command -v "$tool" >/dev/null || { echo "setup: missing: $tool"; missing=1; }
    done
    exit "${missing:-0}"
fi

missing=()
for package in "${packages[@]}"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

run=()
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "setup: as root, run: apt-get install ${missing[*]}"; exit 1; }
    run=(sudo)
fi
echo "setup: installing ${missing[*]}"
"${run[@]}" apt-get update -qq
# A name that this release does not have (clang-format-14 on newer ones) must not stop the rest.
available=()
for package in "${missing[@]}"; do
    if apt-cache show "$package" >/dev/null 2>&1; then available+=("$package"); else echo "setup: no package $package here, going on without"; fi
done
"${run[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${available[@]}" >/dev/null
