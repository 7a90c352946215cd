#!/usr/bin/env bash
# Installs every Debian package that ViP-Lab needs to build, run and test. Safe to run again.
set -euo pipefail

packages=(
  # build
  g++ cmake ninja-build pkg-config
  # libraries fixed by the project
  libgl-dev libegl-dev libepoxy-dev libglfw3-dev libx11-dev libimgui-dev libsqlite3-dev libgsl-dev libcli11-dev libgtest-dev libgmock-dev
  libopenxr-dev libopenxr-loader1
  # texts, TOML, JSON, PNG, compression, checksums, SHA-256
  libfmt-dev libtomlplusplus-dev nlohmann-json3-dev libpng-dev libzstd-dev zlib1g-dev libxxhash-dev libsodium-dev
  # software OpenGL for machines without a GPU
  libegl1 libgl1 libgl1-mesa-dri
  # type of the participant's window
  fonts-dejavu-core
  # scripts/sweep.smk: many cells on many cores or a cluster
  snakemake
  # tests
  sqlite3 openxr-layer-corevalidation util-linux xvfb xauth xdotool imagemagick clang-tidy
)

# The BIDS validator's (scripts/validate_bids.sh); whoever has npm from elsewhere keeps it.
command -v npm >/dev/null || packages+=(nodejs npm)

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
