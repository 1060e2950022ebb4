#!/usr/bin/env bash
# tests/examples/fit_parts.sh -- examples/08_fit_parts on inputs made here: what it writes, finds and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/fit_parts.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's: a box of a car, seen from its side by a small camera.
set -uo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
source "$here/box_car.sh"

given=(--photo photo.ppm --mask mask.pgm --parts parts.pgm --camera camera.json --vehicle car.obj --environment sky.ppm --yaw 0)
fit() { "$program" "${given[@]}" --patience 0 "$@"; }
help=$("$program" --help) || fail "--help does not end with 0"
[[ $help == *"08_fit_parts --photo"* ]] || fail "--help has no example"

# ---- what it writes; the photo's paint is blue, and so is the fitted one
log=$(fit --steps 60 --threads 1 --compare --output bank 2>&1) || fail "a run: $log"
for file in fit.png after.png compare.png loss.png gbuffer.png gbuffer.exr report.html {paint,glass,rubber}{,.state}.json; do
  [ -s bank/"$file" ] || fail "$file is not written"
done
[ -z "$(find . -name '*.partial')" ] || fail "partial files are left"
grep -q "without *with" <<<"$log" || fail "no table of both fits"
blue() { awk -F'[:,]' '/base_color.x/ { r = $2 } /base_color.z/ { b = $2 } END { exit !(b > 3 * r) }' "$1"/paint.json || fail "$1: the paint is not blue"; }
blue bank
fit --steps 60 --threads 2 --output threads >threads.log 2>&1
for m in paint glass rubber; do cmp -s bank/$m.json threads/$m.json || fail "$m.json differs by the number of threads"; done

# ---- labels of the model's picture outweigh names: all of it is paint
sed '4,$s/[1-9][0-9]*/1/' parts.pgm >all_paint.pgm
log=$(fit --steps 5 --model-parts all_paint.pgm --output labels 2>&1) || fail "a run with labels of the model: $log"
grep -q "tire *paint" <<<"$log" && ! grep -q "tire *rubber" <<<"$log" || fail "--model-parts is not heeded: $log"

# ---- a network: two convolutions, from a .safetensors file; and one by a wrong name
network() { # NAME FILE: 4 x 3 x 3 x 3 weights of 1/16 and 4 biases of 4
  local header weights="" i
  header=$(printf '{"%s.weight":{"dtype":"F32","shape":[4,3,3,3],"data_offsets":[0,432]},"%s.bias":{"dtype":"F32","shape":[4],"data_offsets":[432,448]}}' "$1" "$1")
  while [ $((${#header} % 8)) != 0 ]; do header+=" "; done
  for ((i = 0; i < 108; ++i)); do weights+='\x00\x00\x80\x3d'; done
  for ((i = 0; i < 4; ++i)); do weights+='\x00\x00\x80\x40'; done
  # shellcheck disable=SC2059
  { printf "\\x$(printf %02x $((${#header} % 256)))\\x$(printf %02x $((${#header} / 256)))\\x00\\x00\\x00\\x00\\x00\\x00"; printf '%s' "$header"; printf "$weights"; } >"$2"
}
network features.0 net.safetensors
network conv net_by_name.safetensors
log=$(fit --steps 60 --features net.safetensors --gram-every 3 --output network 2>&1) || fail "a run with a network: $log"
blue network
cmp -s network/paint.json bank/paint.json && fail "the network changes nothing"

# ---- a known paint is drawn and found again
log=$(fit --steps 30 --known bank/paint.json --compare --output known 2>&1) || fail "a known paint: $log"
grep -q "known *without *with" <<<"$log" || fail "no table of the known paint"

# ---- what it refuses: one line, exit 2, nothing written
refuses "none.safetensors: no such file" --features none.safetensors
refuses "net_by_name.safetensors: found no convolution" --features net_by_name.safetensors
refuses "parts.pgm: ends within its header" --features parts.pgm
refuses "none.pgm: no such file" --model-parts none.pgm
refuses "none.json: no such file" --known none.json
refuses "--pooling" --pooling median
refuses "--gram" --gram -1
refuses "the vehicle has no such material" --role wood=paint
[ $failed = 0 ] && echo "all is well"
exit $failed
