#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a compiler and keeps what it says in OUTPUT.ptxas beside its output file: ptxas reports
# registers and spills there (tools/check_ptxas.py reads it), and the build prints it only once.
set -uo pipefail
output=""
for ((i = 1; i <= $#; ++i)); do
    if [ "${!i}" = "-o" ]; then j=$((i + 1)); output="${!j}"; fi
done
[ -n "$output" ] || exec "$@"
"$@" 2>"$output.ptxas"
status=$?
# Everything but ptxas' figures is for the reader of the build.
grep -v -E '^(ptxas info|    [0-9]+ bytes stack frame|$)' "$output.ptxas" >&2
exit $status
