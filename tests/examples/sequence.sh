#!/usr/bin/env bash
# tests/examples/sequence.sh -- examples/14_sequence on inputs made here: one run, many jobs and a resumed run agree
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/sequence.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's.
set -uo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
source "$here/box_car.sh"
given=(--vehicle car.obj --environment sky.ppm --size 96 --samples 2 --at 0,9 --heading 60 --pitch 0 --frames 3)

"$program" --help | grep "14_sequence --twin" >/dev/null || fail "--help has no example"
log=$("$program" "${given[@]}" --output whole 2>&1) || fail "a run: $log"
for file in sequence.json coco.json sheet.png {frames,masks}/000002.png gbuffers/000002.exr labels/000000.txt; do
  [ -s whole/$file ] || fail "no $file"
done
[ "$(grep -o '"image_id"' whole/coco.json | wc -l)" = 3 ] || fail "not three annotations"
# It drives away: further ahead from frame to frame.
awk '{ print $14 }' whole/labels/*.txt | sort -n -c || fail "it does not drive away"
# One frame a job, in any order.
for k in 2 0 1; do "$program" "${given[@]}" --output jobs --frame $k >/dev/null 2>&1 || fail "frame $k alone"; done
[ ! -e jobs/coco.json ] || fail "a job collects"
"$program" "${given[@]}" --output jobs --collect >/dev/null 2>&1 || fail "collecting"
diff -rq whole jobs | grep -v '\.exr ' | grep . && fail "jobs give another folder than one run"
# What is there stays; what is missing is made again, the same.
rm whole/labels/000001.txt whole/frames/000001.png
before=$(stat -c %Y%i whole/frames/000000.png)
log=$("$program" "${given[@]}" --output whole 2>&1) || fail "going on: $log"
grep -q "1 made" <<<"$log" || fail "not one frame was made: $log"
[ "$(stat -c %Y%i whole/frames/000000.png)" = "$before" ] || fail "a frame that was there was made again"
cmp whole/frames/000001.png jobs/frames/000001.png || fail "a frame comes out otherwise the second time"
"$program" "${given[@]}" --trajectory rotate --output round >/dev/null 2>&1 || fail "a trajectory"
[ "$(awk '{ print $15 }' round/labels/*.txt | sort -u | wc -l)" = 3 ] || fail "it does not turn"

# Two panoramas along the way, on ground that is darker to the right: a frame alone is what it is in a whole run.
awk 'BEGIN { print "P3\n240 160\n255"
  for (j = 0; j < 160; ++j) for (i = 0; i < 240; ++i) { k = j < 80 ? 180 : 200 - int(i / 2); print k, k, k } }' >slope.ppm
awk 'NR < 4 { print; next } { print $3, $2, $1 }' sky.ppm >evening.ppm
echo '{"lights": [{"at": [0, 9], "panorama": "sky.ppm"}, {"at": [5, 12], "panorama": "evening.ppm"}]}' >lights.json
along=(--plate slope.ppm --lights lights.json --length 8)
"$program" "${given[@]}" "${along[@]}" --output along >/dev/null 2>&1 || fail "a run along two panoramas"
"$program" "${given[@]}" "${along[@]}" --output alone --frame 2 >/dev/null 2>&1 || fail "its last frame alone"
cmp along/frames/000002.png alone/frames/000002.png || fail "the last frame alone is lit otherwise"

refuses "expected drive, rotate, occluded or doors" --trajectory fly
refuses "the sequence has frames 0 to 2" --frame 3
refuses "no frame of this sequence is there" --collect
log=$("$program" "${given[@]}" --heading 10 --output whole 2>&1)
grep -q "another sequence's recipe" <<<"$log" || fail "another recipe is taken"
[ $failed = 0 ] && echo "all is well"
exit $failed
