#!/usr/bin/env bash
# The file of the API against a running server: every operation is asked with data made from its schema, fitting and not, and every answer is
# held against what the file says (status, type, body), no operation may answer 5xx, none may be open that says it is not.
# Skips, visibly, without Python.
#
# Left out of the checks, with reasons:
#   positive_data_acceptance    what fits the schema may still be refused: a level that the mine does not have, a zone that is there already
#   ensure_resource_availability, use_after_free    people and zones have ids of the user's choice: the tool's links do not know them
#   stateful phase              as before
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=target/schemathesis
python=$(command -v python3 || true)
[ -n "$python" ] || { echo "SKIPPED (no Python): schemathesis"; exit 0; }
if [ ! -x "$venv/bin/schemathesis" ]; then
    "$python" -m venv "$venv" && "$venv/bin/pip" --quiet install 'schemathesis>=4.32,<5' \
        || { echo "SKIPPED (schemathesis cannot be installed)"; exit 0; }
fi
# The whole workspace names the features of its dependencies, so that what the tests have built is used.
cargo build --locked --workspace --example api_house

told=$(mktemp -d)
trap 'exec 3>&-; wait; rm -rf "$told"' EXIT
mkfifo "$told/in" "$told/out"
target/debug/examples/api_house <"$told/in" >"$told/out" &
exec 3>"$told/in" 4<"$told/out"
read -r url <&4
read -r token <&4

"$venv/bin/schemathesis" run "$url/api/v1/openapi.json" \
    --header "Authorization: Bearer $token" \
    --phases examples,coverage,fuzzing --max-examples "${SCHEMATHESIS_EXAMPLES:-20}" --seed 1 --no-color \
    --exclude-checks positive_data_acceptance,ensure_resource_availability,use_after_free \
    "$@"
