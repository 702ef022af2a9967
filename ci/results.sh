#!/usr/bin/env bash
# Regenerates every figure of the docs:
#   a block from `<!-- NAME:begin -->` to `<!-- NAME:end -->` of a page: the table NAME made below (`results`: the recorded
#   sets with truth, `everything`, `everything-matrix`, `everything-parts`: the suite scenarios/everything.toml in short, as a table of parts and methods, and part by part, `loops`: the walks without, `attitude`: the attitude trials next to VQF, `parts`: the same with a part of
#   the method left out, `walks`: the simulated walk of system S2 over many seeds,
#   `radio-positions`: every method by signal strength and range on the recorded radio sets, `steel`: what a steel car does to a compass on the walk of system S3, `marg`: the walks of S3 over many seeds, `s0`: system S0 over many seeds, `s1`: system S1 over many seeds, `s1-fitness`: what tuning it costs, `s4`: system S4 over many seeds, `ranges`: errors of recorded ranges before and after correction, `uwb`: every method on UWB ranges on the recorded sets, `radio`: simulated radio next to recorded sets,
#   `blackout-foot`, `blackout-waist`, `survival`: runs through a blackout over many seeds, `radius`: how often the truth is within the stated radius,
#   `roadways`: walks without infrastructure held to roadways, `shift`: speed and memory of simulating everybody in a mine, `steps`: counted steps of the recorded sets, `phone-walks`: dead reckoning at the waypoints of the recorded walks with a phone,
#   `optimise`: the optimisers and mealpy's, whose numbers are made anew in crates/tuning/tests/reference/mealpy.csv, `optimise-tails`: a choice
#   that the paper leaves);
#   a block from `<!-- run:begin adit … -->` to `<!-- run:end -->`: what this command prints, run after `adit demo --walk`;
#   docs/results/trials.md, docs/results/demo-path.svg, docs/results/demo-evaluation.svg, docs/results/stance.svg,
#   docs/results/ahrs-delay.svg, docs/results/steel-norm.svg, docs/results/steel-heading.svg, docs/results/marg-heading.svg,
#   docs/results/s0-position.svg, docs/results/s1-distribution.svg, docs/results/s4-distribution.svg, docs/results/uwb-gate.svg, docs/results/pdr-steps.svg, docs/results/radio.svg, docs/results/radio-positions.svg, docs/results/ranges.svg, docs/results/ranging.svg, docs/results/nlos.svg, docs/results/people-plan.svg, docs/results/roadways.svg, docs/results/blackout.svg, docs/results/tune.svg (of the first command of docs/tune.md), docs/results/magnetometer.svg, docs/results/allan.svg (of logs that the example simulated_calibration makes), docs/results/optimise-convergence.svg.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
. ci/data.sh
. ci/rival/venv.sh

[ -d "$ADIT_DATA" ] || { echo "results: no recorded sets at $ADIT_DATA (set ADIT_DATA)" >&2; exit 1; }
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT

if [ -n "$mealpy_python" ]; then
    "$mealpy_python" ci/rival/mealpy_optimisers.py 30 >"$fresh/mealpy.csv"
    cp "$fresh/mealpy.csv" crates/tuning/tests/reference/mealpy.csv
fi
cargo build --locked --release -p adit-cli --bin adit --example recorded_results --example everything_results --example attitude_results --example attitude_parts --example simulated_walks --example stance_figure --example steel_figure --example marg_walks --example marg_figure --example simulated_calibration --example s0_results --example s1_results --example s4_results --example uwb_results --example gate_figure --example radio_results --example range_results --example radio_figure --example ranging_figure --example shift_results --example blackout_results --example step_results --example step_figure --example phone_walks
cargo build --locked --release -p adit-simulation --example radio_realism --example people_plan
cargo build --locked --release -p adit-estimation --example roadway_walks --example roadway_figure
cargo build --locked --release -p adit-nlos --example simulated_mines --example class_figure
cargo build --locked --release -p adit-tuning --example optimise_results --example s1_fitness
bin=$(cd "${CARGO_TARGET_DIR:-target}/release" && pwd)

# What could be measured is written even when a trial failed; the exit code tells.
complete=0
"$bin/examples/recorded_results" "$bin/adit" "$ADIT_DATA" "$fresh" || complete=$?
[ -f "$fresh/trials.md" ] || exit 1
cp "$fresh/trials.md" docs/results/trials.md
mv "$fresh/sets.md" "$fresh/results.md"

if [ -n "$rival_python" ]; then
    "$bin/examples/attitude_results" "$bin/adit" "$ADIT_DATA" "$rival_python" "$fresh/attitude.md" || complete=$?
fi
"$bin/examples/attitude_parts" "$ADIT_DATA" "$fresh/parts.md" docs/results/ahrs-delay.svg || complete=$?
# A table without the rival would say less than the one that stands there.
[ -f "$fresh/attitude.md" ] || echo "results: the attitude table is left as it is" >&2

# Every method on everything; the table stays as it is where a recorded set is not at hand, since it would say less.
"$bin/adit" compare scenarios/everything.toml -o "$fresh/everything.html" --json "$fresh/everything.json" >/dev/null
if grep -q 'SKIPPED (no test data)' "$fresh/everything.json"; then
    echo "results: a recorded set is missing, the tables of everything are left as they are" >&2
else
    "$bin/examples/everything_results" "$fresh/everything.json" "$fresh"
fi

"$bin/examples/simulated_walks" >"$fresh/walks.md"
"$bin/examples/stance_figure" docs/results/stance.svg
"$bin/examples/steel_figure" docs/results/steel-norm.svg docs/results/steel-heading.svg >"$fresh/steel.md"
"$bin/examples/marg_walks" "$bin/adit" >"$fresh/marg.md"
"$bin/examples/marg_figure" "$bin/adit" docs/results/marg-heading.svg
"$bin/examples/radio_results" "$bin/adit" "$ADIT_DATA" "$fresh/radio-positions.md" || complete=$?
"$bin/examples/radio_figure" docs/results/radio-positions.svg
"$bin/examples/ranging_figure" mines/lab.toml docs/results/ranging.svg
"$bin/examples/range_results" "$bin/adit" "$ADIT_DATA" "$fresh/ranges.md"
"$bin/adit" calibrate range "$ADIT_DATA/uwb-industrial" -o "$fresh/hall.toml" --plot docs/results/ranges.svg >/dev/null
"$bin/examples/s0_results" "$bin/adit" scenarios "$fresh/s0.md" docs/results/s0-position.svg
"$bin/examples/step_results" "$bin/adit" "$ADIT_DATA" "$fresh/steps.md" || complete=$?
"$bin/examples/phone_walks" "$bin/adit" "$ADIT_DATA" "$fresh/phone-walks.md" || complete=$?
"$bin/examples/step_figure" docs/results/pdr-steps.svg
"$bin/examples/radio_realism" "$ADIT_DATA" "$fresh/radio.md" docs/results/radio.svg >/dev/null
"$bin/examples/people_plan" docs/results/people-plan.svg
"$bin/examples/s1_results" "$bin/adit" scenarios "$fresh/s1.md" docs/results/s1-distribution.svg
"$bin/examples/s4_results" "$bin/adit" scenarios "$fresh/s4.md" docs/results/s4-distribution.svg
"$bin/examples/uwb_results" "$bin/adit" "$ADIT_DATA" "$fresh/uwb.md" || complete=$?
"$bin/examples/gate_figure" docs/results/uwb-gate.svg
"$bin/examples/s1_fitness" "$fresh/walks.csv" "$fresh/s1-fitness.md" ${mealpy_python:+"$mealpy_python" ci/rival/mealpy_s1.py} >/dev/null
"$bin/examples/optimise_results" "$fresh/optimise.md" "$fresh/optimise-tails.md" docs/results/optimise-convergence.svg
"$bin/examples/shift_results" "$bin/adit" scenarios/shift.toml "$fresh/shift.md"
"$bin/examples/roadway_walks" 100 mines/two-level.toml >"$fresh/roadways.md"
"$bin/examples/roadway_figure" docs/results/roadways.svg
# Half an hour in the dark; a log and its truth are some 100 MB while a seed runs.
"$bin/examples/blackout_results" dark "$bin/adit" scenarios/blackout.toml 100 "$fresh/blackout-foot.md" "$fresh/blackout-foot.json" docs/results/blackout.svg
"$bin/examples/blackout_results" dark "$bin/adit" scenarios/blackout-waist.toml 100 "$fresh/blackout-waist.md" "$fresh/blackout-waist.json" "$fresh/blackout-waist.svg"
"$bin/examples/blackout_results" dark "$bin/adit" scenarios/survival.toml 20 "$fresh/survival.md" "$fresh/survival.json" "$fresh/survival.svg"
"$bin/examples/blackout_results" radius "$bin/adit" scenarios fused 10 "$fresh/radius.md"

mkdir "$fresh/here"
ln -s "$PWD/scenarios" "$fresh/here/scenarios"
ln -s "$ADIT_DATA" "$fresh/here/data"
"$bin/examples/simulated_calibration" "$fresh/here"
# Rooms that no model has seen.
"$bin/examples/simulated_mines" "$fresh/here/rooms" 50 2
"$bin/examples/class_figure" mine docs/results/nlos.svg "$fresh"/here/rooms/*

# What a command prints, without the lines that no two runs have in common.
run() {
    (cd "$fresh/here" && PATH="$bin:$PATH" bash -c "$1") | sed -e '/^speed /d' -e 's/ *$//'
}

run 'adit demo --walk' >"$fresh/demo.txt"
cp "$fresh/here/out/demo/path.svg" docs/results/demo-path.svg
cp "$fresh/here/out/demo/evaluation.svg" docs/results/demo-evaluation.svg

# A page with its blocks made anew.
renew() {
    local line name inside=
    while IFS= read -r line; do
        case $line in
        '<!-- '*':end -->') inside= ;;
        esac
        if [ -z "$inside" ]; then printf '%s\n' "$line"; fi
        case $line in
        '<!-- run:begin adit '*' -->')
            inside=yes
            line=${line#<!-- run:begin } line=${line% -->}
            printf '\n```text\n$ %s\n%s\n```\n\n' "$line" "$(run "$line")"
            ;;
        '<!-- '*':begin -->')
            name=${line#<!-- } name=${name%:begin -->}
            # What could not be made anew stays as it is.
            if [ -f "$fresh/$name.md" ]; then
                inside=yes
                printf '\n%s\n\n' "$(cat "$fresh/$name.md")"
            fi
            ;;
        esac
    done <"$1"
}

for page in $(grep -rlE --include='*.md' '^<!-- [a-z0-9-]+:begin' README.md docs); do
    renew "$page" >"$fresh/page"
    cp "$fresh/page" "$page"
    echo "results: wrote $page"
done
cp "$fresh/here/tumble.svg" docs/results/magnetometer.svg
cp "$fresh/here/allan.svg" docs/results/allan.svg
cp "$fresh/here/tune.svg" docs/results/tune.svg
cat "$fresh/results.md" "$fresh/loops.md"
exit $complete
