#!/usr/bin/env bash
# Every check of the repository, each run whatever failed before it; the last line is `N passed, N failed, N skipped`.
#
# A check script counts as one, a Rust test as one. A test that prints `SKIPPED (no test data): <set>` counts as
# skipped and not as passed, as does an ignored one. Exit 1 if anything failed. Runs on what a fresh machine has: bash,
# awk, Rust, a C compiler; cargo-nextest when it is there.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. ci/data.sh

passed=0 failed=0 skipped=0
logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT
touch "$logs/sets" "$logs/parts"

# report NAME EXIT_CODE PASSED FAILED SKIPPED: adds up; a part that exits with an error but names no failure failed once.
report() {
    local name=$1 code=$2 p=$3 f=$4 s=$5
    if [ "$code" -ne 0 ] && [ "$f" -eq 0 ]; then f=1; fi
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
    printf '%-12s %5d passed %5d failed %5d skipped %6d s\n' "$name" "$p" "$f" "$s" $((SECONDS - started)) >>"$logs/parts"
}

begin() {
    printf '\n==> %s\n' "$*"
    started=$SECONDS
}

# check NAME COMMAND…: one check.
check() {
    local name=$1 code=0
    shift
    begin "$name: $*"
    "$@" || code=$?
    report "$name" "$code" $((code == 0)) $((code != 0)) 0
}

# Figures of `cargo test -- --show-output`: passed, failed, skipped; the sets that were missing go to the file `sets`.
count_libtest() {
    awk -v sets="$logs/sets" '
        /^successes:$/ { passing = 1 }
        /^failures:$/  { passing = 0 }
        /^---- .* stdout ----$/ { fresh = 1 }
        /SKIPPED \(no test data\): / {
            sub(/.*SKIPPED \(no test data\): /, ""); print >> sets
            if (passing && fresh) { missing++; fresh = 0 }
        }
        /^test result: / {
            for (i = 2; i <= NF; i++) {
                if ($i ~ /^passed/) p += $(i - 1)
                if ($i ~ /^failed/) f += $(i - 1)
                if ($i ~ /^ignored/) ignored += $(i - 1)
            }
        }
        END { print p - missing, f + 0, missing + ignored }' "$1"
}

# The same of nextest, from its JUnit file and, for ignored tests, its summary line.
count_nextest() {
    local junit=$1 output=$2 ignored
    ignored=$(awk '/^ *Summary \[/ { for (i = 2; i <= NF; i++) if ($i ~ /^skipped/) n = $(i - 1) } END { print n + 0 }' "$output")
    awk -v sets="$logs/sets" -v ignored="$ignored" '
        /<testcase / { tests++; bad = missed = 0 }
        /<failure|<error/ { if (!bad) f++; bad = 1 }
        /SKIPPED \(no test data\): / {
            sub(/.*SKIPPED \(no test data\): /, ""); sub(/<.*/, ""); print >> sets
            if (!missed && !bad) missing++
            missed = 1
        }
        END { print tests - f - missing, f + 0, missing + ignored }' "$junit"
}

libtest() {
    local name=$1 code=0
    shift
    begin "$name: $*"
    "$@" 2>&1 | tee "$logs/$name" | awk '/^successes:$/ { quiet = 1 } /^(failures:$|test result:)/ { quiet = 0 } !quiet'
    code=${PIPESTATUS[0]}
    report "$name" "$code" $(count_libtest "$logs/$name")
}

nextest() {
    local code junit=target/nextest/default/junit.xml # where .config/nextest.toml puts it
    rm -f "$junit"
    begin "tests: $*"
    "$@" 2>&1 | tee "$logs/tests"
    code=${PIPESTATUS[0]}
    if [ -f "$junit" ]; then
        report tests "$code" $(count_nextest "$junit" "$logs/tests")
    else
        report tests 1 0 1 0
    fi
}

check console ci/console.sh
check format cargo fmt --all --check
check repository bash ci/check-docs.sh
check clippy cargo clippy --locked --workspace --all-targets -- -D warnings
# Examples and benches are built by clippy; that they can be linked is shown by `make results` and `make bench`.
if cargo nextest --version >/dev/null 2>&1; then
    nextest cargo nextest run --locked --workspace --lib --bins --tests --no-fail-fast
else
    libtest tests cargo test --locked --workspace --lib --bins --tests --no-fail-fast -- --show-output
fi
# Learning networks: candle takes minutes to build, so it is in no other build.
libtest train cargo test --locked -p adit-nlos --features train --tests --no-fail-fast -- --show-output
libtest doc-tests cargo test --locked --workspace --doc --no-fail-fast
check docs env RUSTDOCFLAGS='-D warnings' cargo doc --locked --workspace --no-deps --quiet
check no-std proofs/no-std/check.sh "estimation mine"
check console-tests ci/console.sh --check
if command -v python3 >/dev/null; then
    check schemathesis ci/schemathesis.sh
else
    echo "SKIPPED (no Python): schemathesis"
fi

printf '\n'
cat "$logs/parts"
sort "$logs/sets" | uniq -c | while read -r count set; do
    echo "SKIPPED (no test data): $set (named by $count tests)"
done
printf '\n%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
[ "$failed" -eq 0 ]
