#!/usr/bin/env bash
# examples/demo.sh -- from a street photo to a twin of its vehicle: installs what is missing, builds, runs, shows where to look
# SPDX-License-Identifier: Apache-2.0
#
#   examples/demo.sh [arguments of 09_twin]
#
# The photo, the vehicles and the panorama come with Debian's and Ubuntu's packages; the pictures go to burnish-demo/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tests/setup.sh

needs "${build_packages[@]}" sweethome3d-furniture blender-data darknet
mkdir -p build
echo "Building the examples (the first time takes minutes)"
if ! { cmake --preset demo && cmake --build --preset demo --target 09_twin; } >build/demo.log 2>&1; then
  cat build/demo.log >&2
  exit 1
fi
build/demo/examples/09_twin --output burnish-demo "$@"
echo
echo "The pictures are in $PWD/burnish-demo:"
ls burnish-demo
