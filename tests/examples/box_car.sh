# tests/examples/box_car.sh -- what the tests of the example programs share: inputs, made in the current folder, and checks
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# A box of a car and a photo of it. The caller sets program, and given, its usual arguments.

failed=0
fail() { echo "FAILED: $*"; failed=1; }
# refuses WORDS ARGUMENTS...: one line, exit 2, nothing written; later arguments outweigh the given ones
refuses() {
  local words=$1 code
  shift
  "$program" "${given[@]}" --output refused "$@" >out.log 2>error.log
  code=$?
  [ $code = 2 ] || fail "$*: exit $code"
  [ "$(wc -l <error.log)" = 1 ] || fail "$*: not one line: $(cat error.log)"
  grep -q "^$(basename "$program"): .*$words" error.log || fail "$*: does not say '$words': $(cat error.log)"
  [ ! -e refused ] || fail "$*: something was written"
  rm -rf refused
}


# box MATERIAL X0 X1 Y0 Y1 Z0 Z1
box() {
  echo "usemtl $1"
  local x y z
  for x in "$2" "$3"; do for y in "$4" "$5"; do for z in "$6" "$7"; do echo "v $x $y $z"; done; done; done
  printf 'f -%d -%d -%d -%d\n' 8 7 5 6 4 2 1 3 8 4 3 7 6 5 1 2 8 6 2 4 7 3 1 5
}
{
  echo "mtllib car.mtl"
  box paint -2 2 0.2 1 -0.8 0.8
  box glass -1 1 1 1.4 -0.7 0.7
  for x in -1.3 1.3; do box tire "$(awk "BEGIN { print $x - 0.35 }")" "$(awk "BEGIN { print $x + 0.35 }")" 0 0.6 -0.85 0.85; done
} >car.obj
printf 'newmtl %s\nKd 0.6 0.6 0.6\n' paint glass tire >car.mtl
echo "map_Kd nowhere.png" >>car.mtl
# The same places by the camera's rule: 100 pixels a unit at a depth of 7.2. 1 paint, 2 glass, 3 rubber.
awk 'BEGIN {
  print "P2\n96 64\n255" >"parts.pgm"; print "P2\n96 64\n255" >"mask.pgm"; print "P3\n96 64\n255" >"photo.ppm"; print "P3\n96 64\n255" >"twotone.ppm"
  for (j = 0; j < 64; ++j) for (i = 0; i < 96; ++i) {
    x = (i + 0.5 - 48) / 100 * 7.2; y = 0.7 - (j + 0.5 - 32) / 100 * 7.2; part = 0
    if (x > -2 && x < 2 && y > 0.2 && y < 1) part = 1
    if (x > -1 && x < 1 && y > 1 && y < 1.4) part = 2
    d = x < 0 ? x + 1.3 : x - 1.3
    if (d > -0.35 && d < 0.35 && y > 0 && y < 0.6) part = 3
    print part >"parts.pgm"; print (part > 0 ? 255 : 0) >"mask.pgm"
    color = (part == 1 ? "40 70 160" : part == 2 ? "70 80 90" : part == 3 ? "45 45 45" : y > 0 ? "150 170 200" : "110 110 105")
    print color >"photo.ppm"; print (part == 1 && y > 0.7 ? "235 235 235" : color) >"twotone.ppm"
  }
  print "P3\n32 16\n255" >"sky.ppm"
  for (j = 0; j < 16; ++j) for (i = 0; i < 32; ++i) print (j < 8 ? 170 + 4 * j " " 180 + 3 * j " 220" : "90 85 80") >"sky.ppm"
}'
echo '{"width": 96, "height": 64, "fx": 100, "position": [0, 0.7, 8], "look_at": [0, 0.7, 0]}' >camera.json
