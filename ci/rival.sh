#!/usr/bin/env bash
# adit's streaming method against the same filter on filterpy, on the same walk, one after the other on this machine.
# Needs python3 with venv; installs numpy and filterpy below the target folder.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
target=${CARGO_TARGET_DIR:-target}
venv=$target/rival
command -v python3 >/dev/null || { echo "rival: no python3, comparison left out" >&2; exit 0; }
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
"$venv/bin/python" -c 'import filterpy, numpy' 2>/dev/null || "$venv/bin/pip" -q install 'numpy==2.*' 'filterpy==1.4.5'

cargo build --locked --release -p adit-estimation --example throughput
walk=$(mktemp)
trap 'rm -f "$walk"' EXIT
ours=$("$target/release/examples/throughput" "$walk")
theirs=$(OPENBLAS_NUM_THREADS=1 "$venv/bin/python" ci/rival/filterpy_zupt.py "$walk" 12000)
echo "adit foot-ins, streaming:   $ours samples/s"
echo "filterpy, 15 states:        $theirs samples/s"
echo "ratio:                      $((ours / theirs))"
