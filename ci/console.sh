#!/usr/bin/env bash
# Builds the console (web/) into web/dist, from where the server takes it into the binary; says so where it cannot.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [ ! -f web/package.json ]; then
    echo "no console here: web/package.json is not there"
elif ! command -v npm >/dev/null; then
    echo "SKIPPED (no npm): the console; the binary will have none"
else
    cd web
    npm ci --no-audit --no-fund --loglevel=error
    npm run --silent build
fi
