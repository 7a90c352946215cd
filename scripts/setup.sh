#!/usr/bin/env bash
# Installs the Debian packages that ViP-Lab needs. Safe to run again.
# usage: scripts/setup.sh [PART ...]     without a part: all of them
#   build    packages that building and running the programs needs
#   tests    libraries that the tests are compiled with
#   tools    programs that the tests run
#   slow     further programs, which only the slow tests run
#   sweeps   Snakemake, for scripts/sweep.smk and its tests
#   lint     clang-tidy and the OpenMP header it reads, for scripts/tidy.sh
set -euo pipefail

build=(
  g++ cmake ninja-build pkg-config
  # OpenGL, windows, SQLite, statistics, command lines, OpenXR
  libgl-dev libegl-dev libepoxy-dev libglfw3-dev libx11-dev libimgui-dev libsqlite3-dev libgsl-dev libcli11-dev
  libopenxr-dev libopenxr-loader1
  # texts, TOML, JSON, PNG, compression, checksums, SHA-256
  libfmt-dev libtomlplusplus-dev nlohmann-json3-dev libpng-dev libzstd-dev zlib1g-dev libxxhash-dev libsodium-dev
  # software OpenGL for machines without a GPU
  libegl1 libgl1 libgl1-mesa-dri
  # font of the participant's window; fontconfig finds other fonts of the system
  fonts-dejavu-core libfontconfig-dev
)
tests=(libgtest-dev libgmock-dev libpq-dev)  # libpq: the central database; the programs build without it
tools=(sqlite3 postgresql locales openxr-layer-corevalidation util-linux xvfb xauth)
slow=(xdotool imagemagick)            # for scripts/window_*.sh
slow+=(debootstrap dpkg-dev file)     # for scripts/package.sh
# npm installs the BIDS validator (scripts/validate_bids.sh). An npm that is already installed is used.
command -v npm >/dev/null || slow+=(nodejs npm)
sweeps=(snakemake)
lint=(clang-tidy libomp-dev)  # clang needs its own omp.h

packages=()
[ $# -gt 0 ] || set -- build tests tools slow sweeps lint
for part in "$@"; do
  case "$part" in
    build) packages+=("${build[@]}") ;;
    tests) packages+=("${tests[@]}") ;;
    tools) packages+=("${tools[@]}") ;;
    slow) packages+=("${slow[@]}") ;;
    sweeps) packages+=("${sweeps[@]}") ;;
    lint) packages+=("${lint[@]}") ;;
    *) echo "setup: no part is called '$part'; the parts are build, tests, tools, slow, sweeps and lint." >&2; exit 2 ;;
  esac
done

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "setup: this script knows Debian 12 and its relatives (no apt-get here)." >&2
  echo "       Install the counterparts of: ${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "setup: all ${#packages[@]} packages are installed."
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup: not root and no sudo. As root: apt-get install ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "setup: installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
