# tests/setup.sh -- installs the Debian or Ubuntu packages that are missing; run.sh and demo.sh source it
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash

# What every program of ours is built with. OpenImageIO's package file looks for its tools, Assimp's for zlib; on Debian
# 12 neither is a dependency of the -dev package.
# shellcheck disable=SC2034
build_packages=(g++ cmake ninja-build libembree-dev libopenimageio-dev openimageio-tools libassimp-dev
  zlib1g-dev nlohmann-json3-dev libminizip-dev libcli11-dev libeigen3-dev libopencv-core-dev libopencv-imgproc-dev
  libopencv-dnn-dev)

# needs PACKAGE...: says which are missing and installs them. Asks nothing, but for sudo's password at a terminal.
needs() {
  if ! command -v dpkg-query apt-get >/dev/null; then
    echo "Not Debian or Ubuntu: please have these, by the names they bear here: $*"
    return 0
  fi
  local package missing=() root=()
  for package; do
    dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  echo "Installing what is missing: ${missing[*]}"
  if [ "$(id -u)" -ne 0 ]; then
    if [ -t 0 ] && [ -z "${CI:-}" ]; then root=(sudo); else root=(sudo -n); fi
    if ! "${root[@]}" true 2>/dev/null; then
      echo "No right to install them here. As root: apt-get install --no-install-recommends ${missing[*]}" >&2
      return 2
    fi
  fi
  mkdir -p build
  local apt=("${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300)
  "${apt[@]}" update >build/setup.log 2>&1 || echo "apt-get update failed: trying with the lists that are there."
  if ! "${apt[@]}" install -y --no-install-recommends "${missing[@]}" </dev/null >>build/setup.log 2>&1; then
    tail -n 20 build/setup.log >&2
    echo "The packages above could not be installed (on Ubuntu they are in 'universe'); all is in build/setup.log" >&2
    return 2
  fi
}
