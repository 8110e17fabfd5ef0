#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs a finished build into a scratch prefix, then builds and runs the example as a user would:
# with find_package(noli), with his own warnings as errors, and with nothing of this tree in reach.
#
#   install_test.sh BUILD_FOLDER EXAMPLE_FOLDER CXX_COMPILER [CXX_FLAGS]
set -euo pipefail
build=$(realpath "$1")
example=$(realpath "$2")
compiler=$3
flags=${4:-}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { echo "install test: $*" >&2; exit 1; }

cmake --install "$build" --prefix "$scratch/prefix" >"$scratch/install.log" || { cat "$scratch/install.log"; fail "cmake --install failed"; }
headers=$(cd "$scratch/prefix" && find include -type f | sort | tr '\n' ' ')
[ "$headers" = "include/noli/result.hpp include/noli/scene.hpp include/noli/simulator.hpp " ] || fail "installed headers: $headers"
# What is installed may be moved, and must not remember where it was built.
mv "$scratch/prefix" "$scratch/moved"
if grep -rnF -e "$build" -e "$scratch/prefix" "$scratch/moved" --include='*.cmake'; then
    fail "the package files name folders of the build"
fi

cp -r "$example" "$scratch/example"
lines=$(wc -l <"$scratch/example/main.cpp")
[ "$lines" -lt 40 ] || fail "the example has $lines lines, 40 are too many"
cmake -S "$scratch/example" -B "$scratch/out" -DCMAKE_PREFIX_PATH="$scratch/moved" \
    -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags -Wall -Wextra -Werror" \
    -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >"$scratch/configure.log" 2>&1 || { cat "$scratch/configure.log"; fail "find_package(noli) failed"; }
if grep -nE 'Wshadow|ffp-contract|NOLI_HAVE' "$scratch/out/compile_commands.json"; then
    fail "flags of the library's own build reach its users"
fi
cmake --build "$scratch/out" >"$scratch/build.log" 2>&1 || { cat "$scratch/build.log"; fail "the example does not build"; }
code=0
"$scratch/out/falling_box" >"$scratch/run.log" 2>&1 || code=$?
[ "$code" -eq 0 ] || { tail -n 5 "$scratch/run.log"; fail "the example ended with code $code"; }

# 50 steps of 0.01 s; the box starts 0.2 m above the ground and gets there after 0.2 s.
[ "$(grep -c '^t = ' "$scratch/run.log")" -eq 50 ] || { tail -n 5 "$scratch/run.log"; fail "expected 50 steps"; }
grep -qE '^t = 0\.2.*: [1-9][0-9]* contacts' "$scratch/run.log" || { cat "$scratch/run.log"; fail "the box did not reach the ground in time"; }
if grep -qE '^t = 0\.1.*: [1-9][0-9]* contacts' "$scratch/run.log"; then
    fail "the box touches the ground before it can be there"
fi

if [ -x "$scratch/moved/bin/noli" ]; then
    "$scratch/moved/bin/noli" --version >/dev/null || fail "the installed program does not run"
fi
tail -n 1 "$scratch/run.log"
echo "install test: ok"
