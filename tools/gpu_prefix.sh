#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Collects what a build of Noli needs besides a compiler, CMake and the CUDA toolkit into a folder that can
# be carried to a machine without a package manager and without a network:
#
#     bash tools/gpu_prefix.sh FOLDER [TARBALL]
#
# Runs on Debian or Ubuntu with the packages of tools/setup.sh installed. On the other machine:
#     CMAKE_PREFIX_PATH=FOLDER make gpu-check
set -euo pipefail
[ $# -ge 1 ] || { echo "usage: $0 FOLDER [TARBALL.tar.gz]" >&2; exit 2; }
folder=$1
tarball=${2:-}
command -v dpkg >/dev/null || { echo "gpu_prefix: needs dpkg; run it on Debian or Ubuntu" >&2; exit 1; }
if [ -e "$folder" ] && [ ! -e "$folder/noli-prefix.txt" ] && [ -n "$(ls -A "$folder")" ]; then
    echo "gpu_prefix: $folder holds something else; name a new folder" >&2
    exit 1
fi

# Headers and CMake packages, and the shared libraries that they need at run time.
packages=(libtbb-dev nlohmann-json3-dev libcli11-dev libfmt-dev zlib1g-dev libxxhash-dev libtinyobjloader-dev
    libgtest-dev libgmock-dev libeigen3-dev)
installed() { dpkg-query -W -f='${Status}' "$1" 2>/dev/null | grep -q 'ok installed'; }
missing=()
for package in "${packages[@]}"; do installed "$package" || missing+=("$package"); done
if [ ${#missing[@]} -gt 0 ]; then
    echo "gpu_prefix: not installed: ${missing[*]}; run bash tools/setup.sh" >&2
    exit 1
fi
for package in libtbb12 libtbbmalloc2 libtbbbind-2-5 libfmt9 zlib1g libhwloc15 libtinyobjloader2rc libtinyobjloader1; do
    if installed "$package"; then packages=("$package" "${packages[@]}"); fi
done

mkdir -p "$folder"
{
    echo "What a build of Noli needs besides a compiler, CMake and the CUDA toolkit; made by tools/gpu_prefix.sh from"
    for package in "${packages[@]}"; do dpkg-query -W -f='${Package} ${Version}\n' "$package"; done
} >"$folder/noli-prefix.txt"

for package in "${packages[@]}"; do
    dpkg -L "$package" | while read -r path; do
        case $path in
            /usr/src/* | /usr/share/doc/* | /usr/share/man/* | /usr/share/lintian/* | /usr/share/doc-base/*) continue ;;
            /usr/*) to=$folder/${path#/usr/} ;;
            /lib/*) to=$folder/${path#/} ;;
            *) continue ;;
        esac
        [ -d "$path" ] && [ ! -L "$path" ] && continue
        [ -e "$path" ] || continue
        mkdir -p "$(dirname "$to")"
        cp -a "$path" "$to"
        # A link to a file outside of what is copied becomes the file itself.
        if [ -L "$to" ] && [ ! -e "$to" ]; then cp -L --remove-destination "$path" "$to"; fi
    done
done
# Links that pointed to a later package are whole now; what still dangles is copied.
find "$folder" -xtype l -print | while read -r link; do
    original=/usr/${link#"$folder"/}
    if [ -f "$original" ]; then cp -L --remove-destination "$original" "$link"; fi
done
# An absolute link would point out of the folder on the other machine.
find "$folder" -type l -lname '/*' -print | while read -r link; do
    target=$(readlink "$link")
    if [ -e "$(dirname "$link")/$(basename "$target")" ]; then
        ln -sfn "$(basename "$target")" "$link"
    else
        cp -L --remove-destination "$target" "$link"
    fi
done
echo "gpu_prefix: $folder, $(du -sh "$folder" | cut -f1), ${#packages[@]} packages"
if [ -n "$tarball" ]; then
    tar -C "$(dirname "$folder")" -czf "$tarball" "$(basename "$folder")"
    echo "gpu_prefix: $tarball, $(du -sh "$tarball" | cut -f1)"
fi
