#!/bin/sh
# Builds the proof, runs it, and looks for the standard library in what came out.
#   proofs/no-std/check.sh ["ROOM …"]     rooms to prove on top of core: observation, estimation, mine; default: observation
# Honours CARGO_TARGET_DIR. Exit 0: adit runs without std.
set -eu
cd "$(dirname "$0")"
rooms=${1-observation}
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
fail() { echo "no-std: $*" >&2; exit 1; }

# The versions that ship are the versions proven.
cp ../../Cargo.lock Cargo.lock

# 1. No crate asks for std. What runs on the build machine (proc-macros, build scripts) may.
tree=$(cargo tree --features "$rooms" --edges normal,no-proc-macro --prefix none --format '{p} [{f}]')
if echo "$tree" | grep -E '[[,]std[],]'; then fail "these crates have their feature std on"; fi

# 2. It links without libc and std: a second panic handler, an unwinder or `malloc` would stop the linker.
if [ "$(uname -sm)" = "Linux x86_64" ]; then
    target=x86_64-unknown-linux-gnu
    cargo build --quiet --release --target $target --features "$rooms"
    program="$CARGO_TARGET_DIR/$target/release/adit-no-std-proof"
    [ -z "$(nm --undefined-only "$program")" ] || fail "undefined symbols in $program"
    names=$(nm --demangle "$program")
    for proven in core $rooms; do
        if [ "$proven" = observation ]; then continue; fi # its types leave no symbol behind
        echo "$names" | grep -q "adit_$proven::" || fail "no adit_$proven symbol in $program: the search below would prove nothing"
    done
    if echo "$names" | grep -E '[ <(]std::|__libc|malloc'; then fail "the standard library is in $program"; fi

    # 3. It really runs.
    "$program" || fail "check $? of src/lib.rs failed (99: panic)"
    echo "no-std: core${rooms:+, $rooms} linked and run without std: $(wc -c < "$program") bytes"
fi

# 4. Bare metal, where such a target is installed.
for target in $(rustup target list --installed 2>/dev/null | grep -e '-none' || true); do
    cargo build --quiet --release --lib --target "$target" --features "$rooms"
    echo "no-std: core${rooms:+, $rooms} built for $target"
done
