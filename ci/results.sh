#!/usr/bin/env bash
# Regenerates every figure of the docs:
#   the block from `<!-- results:begin -->` to `<!-- results:end -->` of a page: the recorded sets with truth;
#   the block from `<!-- loops:begin -->` to `<!-- loops:end -->`: the walks without;
#   the block from `<!-- run:begin adit … -->` to `<!-- run:end -->`: what this command prints, run after `adit demo`;
#   the block from `<!-- walks:begin -->` to `<!-- walks:end -->`: the simulated walk of system S2 over many seeds;
#   the block from `<!-- steel:begin -->` to `<!-- steel:end -->`: what steel cars do to the field on the walk of system S3;
#   the block from `<!-- marg:begin -->` to `<!-- marg:end -->`: the simulated walks of system S3 over many seeds;
#   docs/results/trials.md, docs/results/demo-path.svg, docs/results/demo-evaluation.svg, docs/results/stance.svg,
#   docs/results/steel-norm.svg, docs/results/steel-heading.svg, docs/results/marg-heading.svg,
#   docs/results/magnetometer.svg, docs/results/allan.svg (of logs that the example simulated_calibration makes).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. ci/data.sh

[ -d "$ADIT_DATA" ] || { echo "results: no recorded sets at $ADIT_DATA (set ADIT_DATA)" >&2; exit 1; }
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT

cargo build --locked --release -p adit-cli --bin adit --example recorded_results --example simulated_walks --example stance_figure --example steel_figure --example simulated_calibration --example marg_walks --example marg_figure
bin=$(cd "${CARGO_TARGET_DIR:-target}/release" && pwd)

# What could be measured is written even when a trial failed; the exit code tells.
complete=0
"$bin/examples/recorded_results" "$bin/adit" "$ADIT_DATA" "$fresh" || complete=$?
[ -f "$fresh/trials.md" ] || exit 1
cp "$fresh/trials.md" docs/results/trials.md

"$bin/examples/simulated_walks" >"$fresh/walks.md"
"$bin/examples/stance_figure" docs/results/stance.svg
"$bin/examples/steel_figure" docs/results/steel-norm.svg docs/results/steel-heading.svg >"$fresh/steel.md"
"$bin/examples/marg_walks" "$bin/adit" >"$fresh/marg.md"
"$bin/examples/marg_figure" "$bin/adit" docs/results/marg-heading.svg

mkdir "$fresh/here"
ln -s "$PWD/scenarios" "$fresh/here/scenarios"
ln -s "$ADIT_DATA" "$fresh/here/data"
"$bin/examples/simulated_calibration" "$fresh/here"

# What a command prints, without the lines that no two runs have in common.
run() {
    (cd "$fresh/here" && PATH="$bin:$PATH" bash -c "$1") | sed -e '/^speed /d' -e 's/ *$//'
}

run 'adit demo' >"$fresh/demo.txt"
cp "$fresh/here/out/demo/path.svg" docs/results/demo-path.svg
cp "$fresh/here/out/demo/evaluation.svg" docs/results/demo-evaluation.svg

# A page with its blocks made anew.
renew() {
    local line inside=
    while IFS= read -r line; do
        case $line in
        '<!-- results:end -->' | '<!-- loops:end -->' | '<!-- walks:end -->' | '<!-- steel:end -->' | '<!-- marg:end -->' | '<!-- run:end -->') inside= ;;
        esac
        if [ -z "$inside" ]; then printf '%s\n' "$line"; fi
        case $line in
        '<!-- results:begin -->')
            inside=yes
            printf '\n%s\n\n' "$(cat "$fresh/sets.md")"
            ;;
        '<!-- loops:begin -->')
            inside=yes
            printf '\n%s\n\n' "$(cat "$fresh/loops.md")"
            ;;
        '<!-- walks:begin -->')
            inside=yes
            printf '\n%s\n\n' "$(cat "$fresh/walks.md")"
            ;;
        '<!-- steel:begin -->')
            inside=yes
            printf '\n%s\n\n' "$(cat "$fresh/steel.md")"
            ;;
        '<!-- marg:begin -->')
            inside=yes
            printf '\n%s\n\n' "$(cat "$fresh/marg.md")"
            ;;
        '<!-- run:begin adit '*' -->')
            inside=yes
            line=${line#<!-- run:begin } line=${line% -->}
            printf '\n```text\n$ %s\n%s\n```\n\n' "$line" "$(run "$line")"
            ;;
        esac
    done <"$1"
}

for page in $(grep -rlE --include='*.md' '^<!-- (results|loops|walks|steel|marg|run):begin' README.md docs); do
    renew "$page" >"$fresh/page"
    cp "$fresh/page" "$page"
    echo "results: wrote $page"
done
cp "$fresh/here/tumble.svg" docs/results/magnetometer.svg
cp "$fresh/here/allan.svg" docs/results/allan.svg
cat "$fresh/sets.md" "$fresh/loops.md"
exit $complete
