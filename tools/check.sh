#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Format, rooms, licence lines, citations, and clang-tidy on a few files or on those given.
set -euo pipefail
cd "$(dirname "$0")/.."
status=0

sources=$(git ls-files '*.hpp' '*.cpp' '*.cu' '*.cuh')
if command -v clang-format-14 >/dev/null; then
    # shellcheck disable=SC2086
    clang-format-14 --dry-run --Werror $sources && echo "format: ok" || status=1
else
    echo "format: skipped, no clang-format-14"
fi

python3 tools/check_rooms.py src || status=1
python3 tools/check_repo.py || status=1

if command -v clang-tidy-14 >/dev/null && [ -f build/release/compile_commands.json ]; then
    files=${TIDY_FILES:-"src/model/model.cpp src/model/boundary.cpp src/step/trouble.cpp src/sim/state_bytes.cpp"}
    # shellcheck disable=SC2086
    clang-tidy-14 --quiet -p build/release $files 2>/tmp/noli_tidy.log && echo "lint: ok" || { cat /tmp/noli_tidy.log; status=1; }
else
    echo "lint: skipped, no clang-tidy-14 or no build/release"
fi
exit $status
