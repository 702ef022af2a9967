#!/usr/bin/env bash
# Regenerates the measured figures of the docs from the recorded sets: docs/results/trials.md, and every block between
# the lines `<!-- results:begin -->` and `<!-- results:end -->` of a page.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. ci/data.sh

[ -d "$ADIT_DATA" ] || { echo "results: no recorded sets at $ADIT_DATA (set ADIT_DATA)" >&2; exit 1; }
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT

cargo build --locked --release -p adit-cli --bin adit --example recorded_results
bin="${CARGO_TARGET_DIR:-target}/release"
complete=0
"$bin/examples/recorded_results" "$bin/adit" "$ADIT_DATA" "$fresh" || complete=$?

# What could be measured is written even when a trial failed; the exit code tells.
[ -f "$fresh/summary.md" ] || exit 1
cp "$fresh/trials.md" docs/results/trials.md
grep -rl --include='*.md' --exclude-dir=target '^<!-- results:begin -->$' README.md docs | while read -r page; do
    awk -v summary="$fresh/summary.md" '
        /^<!-- results:end -->$/ { inside = 0 }
        !inside { print }
        /^<!-- results:begin -->$/ { inside = 1; print ""; while ((getline line < summary) > 0) print line; print ""; close(summary) }
    ' "$page" >"$fresh/page" && cp "$fresh/page" "$page"
    echo "results: wrote $page"
done
cat "$fresh/summary.md"
exit $complete
