#!/usr/bin/env bash
# Installs packages, builds with warnings as errors, checks the changed sources with clang-tidy, and runs
# every test that needs no GPU and is not labelled slow.
set -euo pipefail
cd "$(dirname "$0")/.."
./scripts/setup.sh build tests
# Installs the programs that the tests start: in parallel with the build, or before it if sudo asks for a
# password.
mkdir -p build
if [ "$(id -u)" -eq 0 ] || sudo -n true 2>/dev/null; then
  ./scripts/setup.sh tools >build/setup.log 2>&1 &
  tools=$!
else
  ./scripts/setup.sh tools
  tools=
fi
installed() {
  local pid=$tools
  tools=
  [ -z "$pid" ] || wait "$pid" || { cat build/setup.log >&2; return 1; }
}
trap installed EXIT  # wait for the installation, also after an error
cmake --preset dev
cmake --build --preset dev --parallel "$(nproc)"
installed
./scripts/tidy.sh
ctest --preset dev
