#!/usr/bin/env bash
# tests/examples/insert.sh -- examples/12_insert on inputs made here: what it writes and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/insert.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's.
set -uo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
source "$here/box_car.sh"
given=(--vehicle car.obj --environment sky.ppm --size 160 --samples 4 --at 0,8 --heading 0 --pitch 0)

"$program" --help | grep "12_insert --twin" >/dev/null || fail "--help has no example"
log=$("$program" "${given[@]}" --output street 2>&1) || fail "a run: $log"
for file in composite.png {composite,object,kept,shadow,through,added,gbuffer}.exr mask.png label_kitti.txt label_coco.json; do
  [ -s street/$file ] || fail "no $file"
done
[ -z "$(find . -name '*.partial')" ] || fail "partial files are left"
# Type, truncated, occluded, alpha, the box in the picture, height width length, place x y z, rotation_y.
awk '{ ok = NF == 15 && $1 == "Car" && $2 == 0 && $3 == 0 && $9 == 1.40 && $11 == 4.00 && $14 == 8 && $15 == -1.57
       exit !(ok && $5 < 80 && $7 > 80 && $13 == 1.65) }' street/label_kitti.txt || fail "the label: $(cat street/label_kitti.txt)"
# Half of it beyond the right border.
"$program" "${given[@]}" --at 4.4,8 --output border >/dev/null 2>&1 || fail "a run at the border"
awk '{ exit !($2 > 0.2 && $2 < 0.8 && $7 == 160) }' border/label_kitti.txt || fail "not cut: $(cat border/label_kitti.txt)"
# The plate decides on the size; where there is no vehicle it is kept.
"$program" "${given[@]}" --plate photo.ppm --noise 0 --blur 0 --output plate >/dev/null 2>&1 || fail "a run with a plate"
grep -q '"width":96,"height":64' plate/label_coco.json || fail "not the plate's size"

# A light field: the panorama nearest to the vehicle lights it, as if it were the only one.
awk 'NR < 4 { print; next } { print $3, $2, $1 }' sky.ppm >evening.ppm
echo '{"lights": [{"at": [0, 30], "panorama": "evening.ppm"}, {"at": [1, 9], "panorama": "sky.ppm"}]}' >lights.json
refuses "--lights needs --plate" --lights lights.json
given+=(--plate photo.ppm --noise 0 --blur 0)
"$program" "${given[@]}" --lights lights.json --output near >/dev/null 2>&1 || fail "a run with a light field"
cmp near/composite.png plate/composite.png || fail "not lit by the nearest"
"$program" "${given[@]}" --lights lights.json --at 0,26 --output far >/dev/null 2>&1 || fail "a run further off"
"$program" "${given[@]}" --environment evening.ppm --at 0,26 --output evening >/dev/null 2>&1 || fail "a run in the evening"
cmp far/composite.png evening/composite.png || fail "not lit by the nearest, further off"
"$program" "${given[@]}" --at 0,26 --output noon >/dev/null 2>&1 || fail "a run further off at noon"
cmp -s far/composite.png noon/composite.png && fail "the light makes no difference"
refuses "camera.json: no list" --lights camera.json

refuses "none.exr: no such file" --environment none.exr
refuses "none.obj: no such file" --vehicle none.obj
refuses "none.png: no such file" --plate none.png
refuses "none/twin.json: no such file" --twin none
refuses "sky.ppm: 32 x 16 pixels, the plate has 96 x 64" --depth sky.ppm
refuses "--pixel lies above the horizon" --pixel 80,2
refuses "--wet" --wet 3
[ $failed = 0 ] && echo "all is well"
exit $failed
