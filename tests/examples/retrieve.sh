#!/usr/bin/env bash
# tests/examples/retrieve.sh -- examples/06_retrieve on inputs made here: what it finds, writes, goes on with and refuses
# SPDX-License-Identifier: Apache-2.0
#
#   tests/examples/retrieve.sh PROGRAM FOLDER
#
# FOLDER is emptied first. Needs no data of anyone's.
set -uo pipefail
here=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
program=$(realpath "$1")
rm -rf "$2" && mkdir -p "$2" && cd "$2" || exit 2
source "$here/box_car.sh"
given=(--library cars --photo photo.ppm --mask mask.pgm)
# Besides the car: a van (all of it higher), a car of one material, what is no mesh, and the car once more.
mkdir -p cars/same
cp car.obj car.mtl cars
sed 's/^v \(.*\) 1 \(.*\)/v \1 1.6 \2/; s/^v \(.*\) 1.4 \(.*\)/v \1 2.4 \2/' car.obj >cars/van.obj
sed 's/^usemtl.*/usemtl paint/' car.obj >cars/one.obj
cp car.obj car.mtl cars/same
echo "no mesh" >cars/broken.glb

"$program" --help | grep -q "06_retrieve --library" || fail "--help has no example"
log=$("$program" "${given[@]}" --output found --report 2>&1) || fail "a run: $log"
for file in retrieved.png library.png refused.txt result.json library.safetensors; do
  [ -s found/$file ] || fail "$file is not written"
done
[ -z "$(find . -name '*.partial')" ] || fail "partial files are left"
grep -q "2 vehicles indexed, 1 refused, 1 duplicates, 1 failed" <<<"$log" || fail "not counted right: $log"
for words in "one material on the whole of it" "same as .*/cars/car.obj" "not a mesh that can be read"; do
  grep -q "$words" found/refused.txt || fail "refused.txt does not say: $words"
done
# The photo shows the car from its side.
awk '/^ 1 +cosine/ { ok = $3 > 0.9 && $NF ~ /cars\/car\.obj$/ && ($5 > 80 && $5 < 100 || $5 < -80 && $5 > -100) } END { exit !ok }' \
  <<<"$log" || fail "not the car from its side: $log"
grep -q '"azimuth"' found/result.json || fail "result.json has no azimuth"

# A second run reads nothing; a rule overrules, and is remembered.
log=$("$program" "${given[@]}" --output found 2>&1)
grep -q "0 files read now" <<<"$log" || fail "files are read again: $log"
log=$("$program" --library cars --index-only --accept 'one*' --output found 2>&1)
grep -q "1 files read now.*" <<<"$log" && grep -q "3 vehicles indexed, 0 refused" <<<"$log" || fail "--accept: $log"
log=$("$program" --index-only --output found 2>&1)
grep -q "3 vehicles indexed, 0 refused" <<<"$log" || fail "the rule is forgotten: $log"

# Ctrl-C keeps what is done; the same command goes on.
for i in 1 2 3 4 5 6 7 8; do sed "s/^v \(.*\) 1.4 \(.*\)/v \1 1.5$i \2/" car.obj >"cars/car$i.obj"; done
"$program" --library cars --index-only --workers 1 --output stopped >stopped.log 2>&1 &
for _ in {1..200}; do [ -e stopped ] && break; sleep 0.02; done
sleep 0.3
kill -INT $!
wait $!
code=$?
if [ $code = 130 ]; then
  grep -q "files are left; the same command goes on" stopped.log || fail "Ctrl-C says nothing: $(cat stopped.log)"
  [ -s stopped/library.safetensors ] || fail "Ctrl-C leaves no index"
elif [ $code != 0 ]; then
  fail "Ctrl-C ends with $code"
fi
log=$("$program" --library cars --index-only --output stopped 2>&1)
grep -q "10 vehicles indexed, 1 refused, 1 duplicates, 1 failed" <<<"$log" || fail "it does not go on: $log"

# What it refuses: one line, exit 2, nothing written.
echo "P2 96 64 255 $(printf '0 %.0s' {1..6144})" >empty.pgm
echo "P2 4 4 255 $(printf '255 %.0s' {1..16})" >small.pgm
head -c 300 found/library.safetensors >damaged.safetensors
refuses "none.png: no such file" --mask none.png
refuses "small.pgm: mask 4 x 4, photo 96 x 64" --mask small.pgm
refuses "empty.pgm: the mask is empty" --mask empty.pgm
refuses "none.jpg: no such file" --photo none.jpg
refuses "nowhere: no such folder" --library nowhere
refuses "damaged.safetensors: no usable library index" --index damaged.safetensors
refuses "--top" --top none
refuses "--velvet" --velvet
[ $failed = 0 ] && echo "all is well"
exit $failed
