#!/usr/bin/env bash
# tests/examples/segment.sh -- examples/10_segment on inputs made here: what it finds, writes and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/segment.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's.
set -uo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
source "$here/box_car.sh"
given=(--photo photo.ppm)
# How well a picture agrees with mask.pgm: the intersection over the union.
average() { oiiotool "$@" --printstats | awk '/Stats Avg/ { print $3 }'; }
agreement() {
  awk -v a="$(average "$1" --ch 0 --mulc 1)" -v b="$(average mask.pgm --ch 0 --mulc 1)" \
    -v both="$(average "$1" --ch 0 mask.pgm --ch 0 --mul)" 'BEGIN { print both / (a + b - both) }'
}

"$program" --help | grep -q "10_segment --photo" || fail "--help has no example"
for way in "--box 20,21,76,43" "--point 48,34"; do
  # shellcheck disable=SC2086
  log=$("$program" "${given[@]}" $way --output found 2>&1) || fail "$way: $log"
  grep -q "certainty" <<<"$log" || fail "$way: no certainty: $log"
  [ -s found/segment.png ] || fail "$way: no picture"
  [ -z "$(find . -name '*.partial')" ] || fail "partial files are left"
  iou=$(agreement found/mask.png)
  awk "BEGIN { exit !($iou > 0.85) }" || fail "$way: IoU $iou"
  echo "$way: IoU $iou"
done
# A mask with a hole and a crumb is one piece without holes again.
awk 'NR < 4 { print; next } { n++; print (n == 34 * 96 + 48 ? 0 : n == 200 ? 255 : $1) }' mask.pgm >crumbs.pgm
log=$("$program" "${given[@]}" --mask crumbs.pgm --output cleaned 2>&1) || fail "--mask: $log"
oiiotool mask.pgm cleaned/mask.png --diff >diff.log || fail "the mask is not as it was: $(cat diff.log)"

echo "P2 96 64 255 $(printf '0 %.0s' {1..6144})" >empty.pgm
echo "not a network" >bad.cfg
refuses "none.png: no such file" --photo none.png --point 3,3
refuses "where is the vehicle"
refuses "not in the photo, expected less than 96 x 64" --point 96,3
refuses "expected x0,y0,x1,y1 in the photo" --box 20,20,24,24
refuses "empty.pgm: empty" --mask empty.pgm
refuses "none.cfg: no such file" --point 48,34 --detector none.cfg,none.weights
refuses "none.weights: no such file" --point 48,34 --detector bad.cfg,none.weights
refuses "--point" --point here
[ $failed = 0 ] && echo "all is well"
exit $failed
