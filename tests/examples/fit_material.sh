#!/usr/bin/env bash
# tests/examples/fit_material.sh -- examples/04_fit_material on inputs made here: what it writes, resumes and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/fit_material.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's: a box of a car, seen from its side by a small camera.
set -uo pipefail
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
failed=0
fail() { echo "FAILED: $*"; failed=1; }

# ---- the inputs
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
  print "P2\n96 64\n255" >"parts.pgm"; print "P2\n96 64\n255" >"mask.pgm"; print "P3\n96 64\n255" >"photo.ppm"
  for (j = 0; j < 64; ++j) for (i = 0; i < 96; ++i) {
    x = (i + 0.5 - 48) / 100 * 7.2; y = 0.7 - (j + 0.5 - 32) / 100 * 7.2; part = 0
    if (x > -2 && x < 2 && y > 0.2 && y < 1) part = 1
    if (x > -1 && x < 1 && y > 1 && y < 1.4) part = 2
    d = x < 0 ? x + 1.3 : x - 1.3
    if (d > -0.35 && d < 0.35 && y > 0 && y < 0.6) part = 3
    print part >"parts.pgm"; print (part > 0 ? 255 : 0) >"mask.pgm"
    print (part == 1 ? "40 70 160" : part == 2 ? "70 80 90" : part == 3 ? "45 45 45" : y > 0 ? "150 170 200" : "110 110 105") >"photo.ppm"
  }
  print "P3\n32 16\n255" >"sky.ppm"
  for (j = 0; j < 16; ++j) for (i = 0; i < 32; ++i) print (j < 8 ? 170 + 4 * j " " 180 + 3 * j " 220" : "90 85 80") >"sky.ppm"
}'
echo '{"width": 96, "height": 64, "fx": 100, "position": [0, 0.7, 8], "look_at": [0, 0.7, 0]}' >camera.json
given=(--photo photo.ppm --mask mask.pgm --parts parts.pgm --camera camera.json --vehicle car.obj --environment sky.ppm --yaw 0)
fit() { "$program" "${given[@]}" --patience 0 "$@"; }

# ---- what it writes
help=$("$program" --help) || fail "--help does not end with 0"
[[ $help == *"04_fit_material --photo"* ]] || fail "--help has no example"
log=$(fit --steps 60 --threads 1 --output whole 2>&1) || fail "a run: $log"
for file in fit.png after.png loss.png gbuffer.png gbuffer.exr report.html {paint,glass,rubber}{,.state}.json; do
  [ -s whole/"$file" ] || fail "$file is not written"
done
[ -z "$(find . -name '*.partial')" ] || fail "partial files are left"
grep -o 'src="[^"]\{0,5\}' whole/report.html | grep -vq 'src="data:' && fail "the page is not self-contained"
grep -q 'table' whole/report.html || fail "the page has no numbers"
for words in "corners without a normal" "without usable uvs" "texture nowhere.png cannot be read" "paint .*loss"; do
  grep -q "$words" <<<"$log" || fail "the log does not say: $words"
done
# The photo's paint is blue, and so is the fitted one.
awk -F'[:,]' '/base_color.x/ { r = $2 } /base_color.z/ { b = $2 } END { exit !(b > 3 * r) }' whole/paint.json || fail "the paint is not blue"

# Without labels the paint is told by its colour: glass and tyres do not spoil it.
log=$(fit --parts "" --steps 60 --output unlabelled 2>&1) || fail "a run without labels: $log"
grep -q "no --parts: of [0-9]* pixels on the mask [0-9]* have" <<<"$log" || fail "the log does not say what counts as paint"
awk -F'[:,]' '/base_color.x/ { r = $2 } /base_color.z/ { b = $2 } END { exit !(b > 3 * r) }' unlabelled/paint.json ||
  fail "without labels the paint is not blue"

# ---- the same bits, on any number of threads and in any number of sittings
same() { for m in paint glass rubber; do cmp -s "$1/$m.json" "$2/$m.json" || fail "$m.json of $1 and $2 differ"; done; }
fit --steps 60 --threads 2 --output threads >threads.log 2>&1
same whole threads
fit --steps 25 --threads 2 --output halves >halves.log 2>&1
fit --steps 60 --threads 2 --output halves --resume halves >>halves.log 2>&1
same whole halves

# ---- Ctrl-C leaves what was done, and it can go on
"$program" "${given[@]}" --patience 0 --steps 20000 --output stopped >stopped.log 2>&1 &
for _ in {1..200}; do [ -e stopped/paint.state.json ] && break; sleep 0.05; done
kill -INT $!
wait $!
code=$?
[ $code = 130 ] || fail "Ctrl-C ends with $code"
[ -s stopped/fit.png ] && [ -s stopped/report.html ] || fail "Ctrl-C leaves no picture"
steps=$(($(grep -o '"steps":[0-9]*' stopped/paint.state.json | cut -d: -f2) + 5))
fit --steps $steps --output stopped --resume stopped >>stopped.log 2>&1
fit --steps $steps --output anew >anew.log 2>&1
same stopped anew

# ---- what it refuses: one line, exit 2, nothing written
# refuses WORDS ARGUMENTS...: later arguments outweigh the given ones
refuses() {
  local words=$1 code
  shift
  "$program" "${given[@]}" --output refused "$@" >out.log 2>error.log
  code=$?
  [ $code = 2 ] || fail "$*: exit $code"
  [ "$(wc -l <error.log)" = 1 ] || fail "$*: not one line: $(cat error.log)"
  grep -q "^04_fit_material: .*$words" error.log || fail "$*: does not say '$words': $(cat error.log)"
  [ ! -e refused ] || fail "$*: something was written"
  rm -rf refused
}
oiiotool --pattern constant:color=nan,0,0 96x64 3 -o nan.exr
oiiotool mask.pgm --resize 48x32 -o small.png
oiiotool mask.pgm --mulc 0 -o empty.png
echo '{"width": 96, "height": 65, "fx": 100, "position": [0, 0.7, 8], "look_at": [0, 0.7, 0]}' >other.json
echo '{"width": 96, "height": 64, "fx": 100, "position": [0, 0.7, 8], "look_at": [0, 0.7, 16]}' >away.json
echo '{"width": 96,' >broken.json
echo 'no mesh at all' >text.obj
mkdir -p foreign broken
cp whole/glass.state.json foreign/paint.state.json
echo '{"model": ' >broken/paint.state.json
refuses "none.jpg: no such file" --photo none.jpg
refuses "car.obj: not a picture" --photo car.obj
refuses "nan.exr: pixel (0, 0) is not a number" --photo nan.exr
refuses "small.png: mask 48 x 32, photo 96 x 64" --mask small.png
refuses "empty.png: no pixel" --mask empty.png
refuses "other.json: camera 96 x 65, photo 96 x 64" --camera other.json
refuses "broken.json: not JSON" --camera broken.json
refuses "away.json: the vehicle is not in the picture" --camera away.json
refuses "none.glb: no such file" --vehicle none.glb
refuses "text.obj: " --vehicle text.obj
refuses "none.exr: no such file" --environment none.exr
refuses "expected material=paint" --role paint=velvet
refuses "the vehicle has no such material; it has paint" --role wood=paint
refuses "no material has such a parameter" --freeze velvet
refuses "nowhere/paint.state.json: no such file" --resume nowhere
refuses "broken/paint.state.json: not JSON" --resume broken
refuses "foreign/paint.state.json: " --resume foreign
refuses "photo.ppm.*not a folder" --output photo.ppm/refused
refuses "--steps" --steps many
refuses "--velvet" --velvet
[ $failed = 0 ] && echo "all is well"
exit $failed
