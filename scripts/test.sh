#!/usr/bin/env bash
# Sets up, builds with warnings as errors, and runs every test that needs no GPU.
set -euo pipefail
cd "$(dirname "$0")/.."
./scripts/setup.sh
cmake --workflow --preset dev
