#!/usr/bin/env bash
# tests/examples/panorama.sh -- examples/11_panorama on inputs made here: what it finds, writes and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/panorama.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's.
set -uo pipefail
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
failed=0
fail() { echo "FAILED: $*"; failed=1; }
# refuses WORDS ARGUMENTS...: one line, exit 2, nothing written
refuses() {
  local words=$1 code
  shift
  "$program" --output refused "$@" >out.log 2>error.log
  code=$?
  [ $code = 2 ] || fail "$*: exit $code"
  [ "$(wc -l <error.log)" = 1 ] || fail "$*: not one line: $(cat error.log)"
  grep -q "^$(basename "$program"): .*$words" error.log || fail "$*: does not say '$words': $(cat error.log)"
  [ ! -e refused ] || fail "$*: something was written"
  rm -rf refused
}

# A blue sky with a white sun of 4 degrees at azimuth 0, elevation 45, its glow, and a brown ground; a brown room.
awk 'BEGIN {
  w = 256; h = 128; pi = 3.14159265; print "P3\n256 128\n255" >"sky.ppm"; print "P3\n256 128\n255" >"room.ppm"
  for (y = 0; y < h; ++y) for (x = 0; x < w; ++x) {
    el = pi / 2 - (y + 0.5) / h * pi; az = (x + 0.5) / w * 2 * pi
    c = sin(el) * sin(pi / 4) + cos(el) * cos(pi / 4) * cos(az)
    a = atan2(sqrt(1 - c * c), c) * 180 / pi
    glow = 130 * exp(-a / 25)
    if (el < 0) print 75, 65, 55 >"sky.ppm"
    else if (a < 4) print 255, 255, 255 >"sky.ppm"
    else printf "%d %d %d\n", 70 + glow, 100 + glow, 150 + 0.75 * glow >"sky.ppm"
    if (el > 0.6) print 170, 150, 130 >"room.ppm"; else print 150, 135, 115 >"room.ppm"
  }
}'

"$program" --help | grep -q "11_panorama --panorama" || fail "--help has no example"
log=$("$program" --panorama sky.ppm --output found 2>&1) || fail "a run: $log"
grep -q "the sun is seen" <<<"$log" || fail "the sun is not seen: $log"
awk '/azimuth/ { exit !($3 > -1.5 && $3 < 1.5 && $9 > 43.5 && $9 < 46.5) }' <<<"$log" || fail "not where the sun is: $log"
for file in panorama.exr panorama.png light.json; do [ -s "found/$file" ] || fail "no $file"; done
[ -z "$(find . -name '*.partial')" ] || fail "partial files are left"
# What it wrote serves as a prediction and as the truth.
log=$("$program" --panorama sky.ppm --prediction found/panorama.exr --truth found/panorama.exr --output again 2>&1) ||
  fail "with a prediction: $log"
grep -q "truth" <<<"$log" || fail "no word of the truth: $log"
log=$("$program" --panorama room.ppm --output inside 2>&1) || fail "a room: $log"
grep -q "no sky found" <<<"$log" || fail "a room has a sky: $log"

echo "P3 4 4 255 $(printf '9 9 9 %.0s' {1..16})" >square.ppm
refuses "none.jpg: no such file" --panorama none.jpg
refuses "panorama: 4 x 4, expected" --panorama square.ppm
refuses "HDR prediction: 4 x 4, expected" --panorama sky.ppm --prediction square.ppm
refuses "none.yaml: no such file" --fisheye sky.ppm --calibration none.yaml
refuses "calibration" --fisheye sky.ppm
refuses "none.exr: no such file" --panorama sky.ppm --truth none.exr
refuses "sky.ppm/no: not a folder" --panorama sky.ppm --output sky.ppm/no
refuses "--height" --panorama sky.ppm --height 1
refuses "--velvet" --velvet
[ $failed = 0 ] && echo "all is well"
exit $failed
