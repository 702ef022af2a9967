#!/usr/bin/env bash
# adit against its rivals on the same simulated logs, one after the other on this machine:
#   foot-ins, streaming, and the same filter on filterpy;
#   ahrs, streaming, nine axes, the VQF of the Rust crate uf-ahrs, and the VQF of its authors (Python package, C++ core).
#   line of sight by the network that ships, and onnxruntime with the same weights.
# Needs python3 with venv; installs the Python rivals below the target folder.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
target=${CARGO_TARGET_DIR:-target}
. ci/rival/venv.sh

cargo build --locked --release -p adit-estimation --example throughput --example attitude_throughput
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

ratio() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.1f", a / b }'; }
line() { printf '%-40s %9s samples/s   adit is %s times as fast\n' "$1" "$2" "$(ratio "$ours" "$2")"; }

ours=$("$target/release/examples/throughput" "$scratch/walk.csv")
printf '%-40s %9s samples/s\n' 'adit foot-ins, streaming' "$ours"
if [ -n "$rival_python" ]; then
    line 'filterpy, 15 states' "$(OPENBLAS_NUM_THREADS=1 "$rival_python" ci/rival/filterpy_zupt.py "$scratch/walk.csv" 12000)"
fi

read -r ours theirs < <("$target/release/examples/attitude_throughput" "$scratch/tag.csv")
printf '%-40s %9s samples/s\n' 'adit ahrs, streaming, nine axes' "$ours"
line 'uf-ahrs VQF (Rust), nine axes' "$theirs"
if [ -n "$rival_python" ]; then
    line 'vqf (Python, C++ core), nine axes' "$("$rival_python" ci/rival/vqf_attitude.py "$scratch/tag.csv")"
fi

nlos_python=$(rival_venv rival-onnx 'onnx, onnxruntime' 'onnx==1.23.*' 'onnxruntime==1.32.*') || nlos_python=
cargo build --locked --release -p adit-nlos --example network_speed
model=crates/nlos/models/flat.safetensors
read -r alone together _ < <("$target/release/examples/network_speed" "$model" "$scratch/network")
printf '%-40s %9s responses/s alone, %s in batches of 64\n' 'adit nlos, one core' "$alone" "$together"
if [ -n "$nlos_python" ]; then
    read -r alone_rival together_rival < <("$nlos_python" ci/rival/onnx_network.py "$model" "$scratch/network")
    printf '%-40s %9s responses/s alone, %s in batches of 64\n' 'onnxruntime, one core, same weights' "$alone_rival" "$together_rival"
fi
