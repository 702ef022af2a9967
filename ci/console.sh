#!/usr/bin/env bash
# Builds the console (web/) into web/dist, from where the server takes it into the binary; says so where it cannot.
# With --check: types, form, tests and size besides, then the tests in a real browser (Debian's Chromium, ADIT_CHROMIUM) on a real server
# (ADIT_BIN, else target/debug/adit). ADIT_LONG=600 watches memory for ten minutes; ADIT_PICTURES=docs/live/console takes the pictures of the page.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [ ! -f web/package.json ]; then
    echo "no console here: web/package.json is not there"
    exit 0
fi
if ! command -v npm >/dev/null; then
    echo "SKIPPED (no npm): the console; the binary will have none"
    exit 0
fi
[ -z "${ADIT_PICTURES:-}" ] || ADIT_PICTURES=$(realpath -m "$ADIT_PICTURES")
export ADIT_PICTURES=${ADIT_PICTURES:-}

cd web
npm ci --no-audit --no-fund --loglevel=error
npm run --silent build
if [ "${1:-}" = --check ]; then
    npm run --silent check
    npm run --silent format:check
    npm run --silent test
    npm run --silent test:browser
    if [ -n "$ADIT_PICTURES" ] && command -v pngquant >/dev/null; then
        pngquant --force --ext .png --nofs 160 "$ADIT_PICTURES"/*.png
    fi
    echo "the console passes"
fi
