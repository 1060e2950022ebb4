#!/usr/bin/env bash
# tests/examples/twin.sh -- examples/09_twin on inputs made here: what it finds, writes and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/twin.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's.
set -uo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
source "$here/box_car.sh"

# A library of two: the car, and a van as high as it is long and of the same materials. And a file that is broken.
mkdir library && mv car.obj car.mtl library/
sed 's/car.mtl/van.mtl/; s/ 1\.4 / 3.4 /' library/car.obj >library/van.obj && cp library/car.mtl library/van.mtl
echo "v 1 2" >library/broken.obj
given=(--photo photo.ppm --mask mask.pgm --library library --environment sky.ppm --focal 100 --steps 20 --frames 3)

"$program" --help | grep -q "09_twin --photo" || fail "--help has no example"
log=$("$program" "${given[@]}" --output twin 2>&1) || fail "a run: $log"
for file in index.html twin.glb twin.png camera.json parts.txt paint.json candidates.png fit.png pose.png parts.png; do
  [ -s twin/$file ] || fail "no $file"
done
[ -z "$(find . -name '*.partial')" ] || fail "partial files are left"
grep -q "1 failed" <<<"$log" || fail "the broken file is not told: $log"
[ "$(head -c 4 twin/twin.glb)" = glTF ] || fail "twin.glb is none"
grep -q "^paint.*body" twin/parts.txt || fail "the paint is not the body: $(cat twin/parts.txt)"
grep -q "^glass.*window" twin/parts.txt || fail "the glass is no window: $(cat twin/parts.txt)"
# The photo's paint is blue: its last channel leads.
awk '/paint base_color.x/ { r = $3 } /paint base_color.z/ { b = $3 } END { exit !(b > r) }' <<<"$log" || fail "not blue: $log"
again=$("$program" "${given[@]}" --output twin 2>&1) || fail "a second run: $again"
grep -q "; 0 read now" <<<"$again" || fail "the index was made anew: $again"

echo "P2 2 2 255 255 255 255 255" >small.pgm
refuses "none.png: no such file" --photo none.png
refuses "small.pgm: mask 2 x 2" --mask small.pgm
refuses "none: " --library none
refuses "none.exr: no such file" --environment none.exr
refuses "--point" --point 5
refuses "none.txt: " --parts none.txt
[ $failed = 0 ] && echo "all is well"
exit $failed
