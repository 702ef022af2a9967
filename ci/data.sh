# Sourced by the scripts beside it: ADIT_DATA as an absolute path, since tests run in the folder of their crate.
# Without ADIT_DATA the recorded sets are looked for beside the repository; where there are none, tests skip.
ADIT_DATA="${ADIT_DATA:-../shared/data}"
if [ -d "$ADIT_DATA" ]; then
    ADIT_DATA="$(cd "$ADIT_DATA" && pwd)"
fi
export ADIT_DATA
