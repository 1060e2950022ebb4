#!/usr/bin/env bash
# tests/examples/edit.sh -- examples/13_edit on inputs made here: what it changes, writes and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/edit.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's.
set -uo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
source "$here/box_car.sh"
given=(--vehicle car.obj --environment sky.ppm --relight sky.ppm --size 96 --samples 2 --at 0,8 --heading 0 --pitch 0)

"$program" --help | grep "13_edit --twin" >/dev/null || fail "--help has no example"
log=$("$program" "${given[@]}" --output sheet 2>&1) || fail "a run: $log"
for file in edits.png joints.json edited.glb; do [ -s sheet/$file ] || fail "no $file"; done
grep -q "no wheels" <<<"$log" || fail "does not say that square wheels are none: $log"
# A joint by hand: the car's front opens upwards.
echo '{"joints": [{"name": "nose", "kind": "panel", "pivot": [1, 1, 0], "axis": [0, 0, 1], "low": 0, "high": 80,
  "inward": [0, -1, 0], "region": [[-1, 0, 0, -1], [0, -1, 0, -0.9]]}]}' >nose.json
log=$("$program" "${given[@]}" --joints nose.json --open nose=60 --output nose 2>&1) || fail "a joint by hand: $log"
[ -s nose/composite.png ] && [ -s nose/label_kitti.txt ] || fail "an edit is not written as an insertion"
"$program" "${given[@]}" --over 0.001 --output plain >/dev/null 2>&1 || fail "a run"
# height, of the label: higher with the nose up; on its side as high as it was wide.
high() { awk '{ print $9 }' "$1/label_kitti.txt"; }
awk "BEGIN { exit !($(high nose) > $(high plain) + 0.3) }" || fail "the nose is not up: $(high nose), $(high plain)"
"$program" "${given[@]}" --over 90 --output over >/dev/null 2>&1 || fail "turned over"
awk "BEGIN { exit !($(high over) == 1.70) }" || fail "on its side it is $(high over) m high, not 1.70"
"$program" "${given[@]}" --turntable 3 --output turn >/dev/null 2>&1 || fail "a turntable"
[ -s turn/turn_002.png ] || fail "no third picture of the turntable"

refuses '"wing" is nothing of this vehicle' --open wing=20
refuses "open nose=much: expected joint=degrees" --joints nose.json --open nose=much
refuses "none.json: no such file" --joints none.json --open nose
refuses "nothing is left of the vehicle" --hide paint --hide glass --hide tire
[ $failed = 0 ] && echo "all is well"
exit $failed
