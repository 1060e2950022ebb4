#!/usr/bin/env bash
# tests/examples/assign_parts.sh -- examples/07_assign_parts on inputs made here: what it tells, writes and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/assign_parts.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's.
set -uo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
source "$here/box_car.sh"
given=(--vehicle car.obj)
seen=(--photo photo.ppm --mask mask.pgm --camera camera.json)

"$program" --help | grep -q "07_assign_parts --vehicle" || fail "--help has no example"
log=$("$program" "${given[@]}" "${seen[@]}" --output parts --views 2>&1) || fail "a run: $log"
for file in parts.txt parts.png photo_parts.png photo_parts_shown.png views/view_00.png views/view_15.png; do
  [ -s "parts/$file" ] || fail "no $file"
done
[ -z "$(find . -name '*.partial')" ] || fail "partial files are left"
kind() { awk -F'\t' -v m="$1" '$1 == m { print $2 }' "$2"; }
[ "$(kind paint parts/parts.txt)" = body ] || fail "paint is $(kind paint parts/parts.txt)"
[ "$(kind glass parts/parts.txt)" = window ] || fail "glass is $(kind glass parts/parts.txt)"
# Half of the photo's vehicle is paint, and no pixel is lost.
awk '/^photo/ { gsub(",", ""); p = $4; g = $6; r = $8; o = $10; n = p + g + r + o; exit !(p > n / 3 && g > n / 20) }' <<<"$log" ||
  fail "photo: $(grep ^photo <<<"$log")"

# What is edited comes back, and outweighs names and shapes.
sed 's/^glass\twindow/glass\tlight/' parts/parts.txt >edited.txt
"$program" "${given[@]}" --parts edited.txt --role tire=rim --output edited >/dev/null || fail "edited"
[ "$(kind glass edited/parts.txt)" = light ] || fail "edited glass is $(kind glass edited/parts.txt)"
[ "$(kind tire edited/parts.txt)" = rim ] || fail "tire=rim is $(kind tire edited/parts.txt)"
# Masks: all of every view is a window, so all that is seen is.
mkdir masks
cp parts/views/view_0*.png masks
"$program" "${given[@]}" --masks masks --output masked >out.log 2>error.log && fail "a picture is no label image"
grep -q "masks/view_00.png: value .*, expected 0 to 7" error.log || fail "labels: $(cat error.log)"
rm masks/*
{
  echo "P2 256 192 255"
  for _ in {1..192}; do printf '2 %.0s' {1..256}; done
} >masks/view_03.png  # a name is no format
"$program" "${given[@]}" --masks masks --output masked >out.log 2>error.log || fail "masks: $(cat error.log)"
[ "$(kind paint masked/parts.txt)" = window ] || fail "under masks paint is $(kind paint masked/parts.txt)"

printf 'glass\twindo\n' >wrong.txt
printf 'wood\tbody\n' >unknown.txt
echo "P2 4 4 255 $(printf '255 %.0s' {1..16})" >small.pgm
mkdir empty
refuses "wrong.txt:1: kind \"windo\", expected body, window" --parts wrong.txt
refuses "unknown.txt:1: wood: the vehicle has no such material; it has paint, glass, tire" --parts unknown.txt
refuses "none.txt: no such file" --parts none.txt
refuses "expected material=kind" --role glass
refuses "go together" --photo photo.ppm
refuses "small.pgm: mask 4 x 4, photo 96 x 64" "${seen[@]}" --mask small.pgm
refuses "no view_00.png" --masks empty
refuses "none: no such folder" --masks none
refuses "none.glb: no such file" --vehicle none.glb
[ $failed = 0 ] && echo "all is well"
exit $failed
