#!/bin/sh
# Coverage-guided fuzzing of every parser on stable Rust: fuzz/run.sh [SECONDS_PER_TARGET]
set -eu
seconds=${1:-20}
here=$(cd "$(dirname "$0")" && pwd)
host=$(rustc -vV | sed -n 's/^host: //p')

# Valid files to start from.
(cd "$here/.." && ADIT_SEEDS="$here/corpus" ADIT_MUTATION_SECONDS=0.1 \
    cargo test --quiet -p adit-observation -p adit-mine --test mutated_input)

# What cargo-fuzz passes, without the sanitizer. With a target named, build scripts stay uninstrumented.
sancov=-Cllvm-args=-sanitizer-coverage
export RUSTFLAGS="--cfg fuzzing -Ccodegen-units=1 -Cpasses=sancov-module $sancov-level=4 \
    $sancov-inline-8bit-counters $sancov-pc-table $sancov-trace-compares"
cd "$here"
cargo build --release --target "$host"
binaries=${CARGO_TARGET_DIR:-$here/target}/$host/release
mkdir -p artifacts
for target in log sensor_rows tum truth solution_csv sidecar mine; do
    "$binaries/$target" -max_total_time="$seconds" -timeout=5 -rss_limit_mb=1024 -print_final_stats=0 \
        -artifact_prefix=artifacts/$target- "corpus/$target"
done
