#!/usr/bin/env bash
# tests/examples/match_pose.sh -- examples/05_match_pose on inputs made here: what it finds, writes and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/match_pose.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's.
set -uo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
source "$here/box_car.sh"
given=(--photo photo.ppm --mask mask.pgm --vehicle car.obj --focal 100)

"$program" --help | grep -q "05_match_pose --photo" || fail "--help has no example"
log=$("$program" "${given[@]}" --output found 2>&1) || fail "a run: $log"
[ -s found/pose.png ] || fail "no picture"
grep -q '"belief"' found/poses.json || fail "no candidates: $(cat found/poses.json)"
grep -q "sure of the heading" <<<"$log" || fail "does not say how sure it is: $log"
[ -z "$(find . -name '*.partial')" ] || fail "partial files are left"
# The car was seen from its side, 8 m away; its front and its rear look alike.
awk '/^IoU/ { exit !($2 > 0.93 && (($4 > 85 && $4 < 95) || ($4 < -85 && $4 > -95))) }' <<<"$log" || fail "not the side: $log"
awk -F'[:,]' '/"fx"/ { f = $2 } END { exit !(f > 99.9 && f < 100.1) }' found/camera.json || fail "the focal length was given"

# A bus of the same materials is not what the photo shows.
{ echo "mtllib car.mtl"; box paint -5 5 0.3 3 -1.2 1.2; box tire -3.5 -2.5 0 1 -1.25 1.25; box tire 2.5 3.5 0 1 -1.25 1.25; } >bus.obj
log=$("$program" "${given[@]}" --vehicle bus.obj --output two 2>&1) || fail "two vehicles: $log"
grep -q "^likeliest: car.obj" <<<"$log" || fail "not the car: $log"
"$program" "${given[@]}" --mask-only --output alone >alone.log 2>&1 || fail "--mask-only: $(cat alone.log)"
cp alone/poses.json before.json
"$program" "${given[@]}" --mask-only --output alone >alone.log 2>&1 && cmp -s alone/poses.json before.json || fail "a second run is another"

echo "P2 96 64 255 $(printf '0 %.0s' {1..6144})" >empty.pgm
echo "P2 4 4 255 $(printf '255 %.0s' {1..16})" >small.pgm
refuses "none.png: no such file" --mask none.png
refuses "small.pgm: mask 4 x 4, photo 96 x 64" --mask small.pgm
refuses "mask is empty" --mask empty.pgm
refuses "none.glb: no such file" --vehicle none.glb
refuses "--focal" --focal wide
[ $failed = 0 ] && echo "all is well"
exit $failed
