#!/usr/bin/env bash
# tests/run.sh -- on Debian 12 or Ubuntu 24.04: installs what is missing, builds the tests three ways and runs them
# SPDX-License-Identifier: Apache-2.0
#
#   tests/run.sh              g++, clang, and g++ with sanitizers
#   tests/run.sh --quick      g++ only
#   tests/run.sh --thorough   every function is tried at 10,000 random points instead of 1,000; also with --quick
#
# Exits with 0 when everything passed; the last line counts the tests of all ways.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 2
source tests/setup.sh

quick=
for argument; do
  case "$argument" in
    --quick) quick=1 ;;
    --thorough) export BURNISH_TEST_POINTS=10000 ;;
    -h | --help) sed -n '2,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) echo "tests/run.sh: unknown argument '$argument' (only --quick, --thorough)" >&2; exit 2 ;;
  esac
done

# The clang to test with: the oldest that is here and can compile the library.
find_clang() {
  local name version
  for name in clang++-{16..30} clang++; do
    version=$("$name" -dumpversion 2>/dev/null) && [ "${version%%.*}" -ge 16 ] && command -v "$name" && return
  done
  return 1
}
packages=("${build_packages[@]}" catch2 libglm-dev)
if [ -z "$quick" ] && ! find_clang >/dev/null; then
  if grep -qs '^VERSION_ID="12"' /etc/os-release; then packages+=(clang-16); else packages+=(clang); fi
fi
needs "${packages[@]}" || exit
passed=0 failed=0
# leg PRESET [CMAKE ARGUMENT...]: configures, builds and tests one preset of CMakePresets.json, and adds to the totals
leg() {
  local preset=$1 log=build/$1.log start=$SECONDS summary=
  shift
  printf '\n== %s\n' "$preset"
  command -v ccache >/dev/null && set -- "$@" -D CMAKE_CXX_COMPILER_LAUNCHER=ccache
  if ! cmake --preset "$preset" "$@" || ! cmake --build --preset "$preset" -- -k 0; then
    echo "$preset: not everything could be built; testing what could"
    failed=$((failed + 1))
  fi
  ctest --preset "$preset" -j "$(nproc)" 2>&1 | tee "$log"
  summary=$(sed -nE 's/^[0-9]+% tests passed, ([0-9]+) tests? failed out of ([0-9]+)$/\1 \2/p' "$log")
  if [ -n "$summary" ]; then
    failed=$((failed + ${summary% *}))
    passed=$((passed + ${summary#* } - ${summary% *}))
  else
    echo "$preset: no test was run"
    failed=$((failed + 1))
  fi
  echo "$preset: $((SECONDS - start)) s"
}

mkdir -p build
leg release
if [ -z "$quick" ]; then
  leg clang -D CMAKE_CXX_COMPILER="$(find_clang)"
  leg sanitize
fi
printf '\n%d passed, %d failed\n' "$passed" "$failed"
[ "$failed" -eq 0 ]
