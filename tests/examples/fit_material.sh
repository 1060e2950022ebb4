#!/usr/bin/env bash
# tests/examples/fit_material.sh -- examples/04_fit_material on inputs made here: what it writes, resumes and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/fit_material.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's: a box of a car, seen from its side by a small camera.
set -uo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
source "$here/box_car.sh"

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

# Without labels the paint is told by its colour: a white roof does not spoil it.
log=$(fit --photo twotone.ppm --parts "" --steps 100 --output unlabelled 2>&1) || fail "a run without labels: $log"
grep -q "no --parts: of [0-9]* pixels on the mask [0-9]* have" <<<"$log" || fail "the log does not say what is paint"
awk -F'[:,]' '/base_color.x/ { r = $2 } /base_color.z/ { b = $2 } END { exit !(r < 0.02 && b > 0.2) }' \
  unlabelled/paint.json || fail "without labels a white roof is in the paint: $(grep base_color unlabelled/paint.json)"

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
