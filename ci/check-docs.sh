#!/usr/bin/env bash
# Rules of the repository that no compiler checks. Prints each breach as `file:line: what`; exit 1 if there is one.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

LONGEST_SOURCE=500      # lines; a longer file is split by subject
LARGEST_FILE=1048576    # bytes

files=$(git ls-files --cached --others --exclude-standard | sort -u | while read -r f; do if [ -f "$f" ]; then echo "$f"; fi; done)
of() { grep -E "$1" <<<"$files" || true; }

# Heading anchors of a Markdown file, as forges make them.
anchors() {
    awk '/^(```|~~~)/ { fenced = !fenced } !fenced && sub(/^#+ +/, "") {
        line = tolower($0); gsub(/[^[:alnum:] _-]/, "", line); gsub(/ /, "-", line); print line }' "$1"
}

# Relative links of a Markdown file, code left out: `line target`.
links() {
    awk '/^ *(```|~~~)/ { fenced = !fenced; next } !fenced {
        gsub(/`[^`]*`/, ""); line = $0
        while (match(line, /\]\([^)]+\)/)) {
            target = substr(line, RSTART + 2, RLENGTH - 3); line = substr(line, RSTART + RLENGTH)
            sub(/ +".*"$/, "", target)
            if (target !~ /^[a-z]+:/) print FNR, target
        } }' "$1"
}

check_links() {
    local page line target path anchor
    for page in $(of '\.md$'); do
        while read -r line target; do
            path=${target%%#*} anchor=
            case $target in *'#'*) anchor=${target#*#} ;; esac
            if [ -z "$path" ]; then path=$page; else path=$(dirname "$page")/$path; fi
            if [ ! -e "$path" ]; then
                echo "$page:$line: link to $target: no such file"
            elif [ -n "$anchor" ] && [ "${path%.md}" != "$path" ] && ! anchors "$path" | grep -qx -e "$anchor"; then
                echo "$page:$line: link to $target: no such heading"
            fi
        done < <(links "$page")
    done
}

check_lengths() {
    local file lines
    for file in $(of '^crates/[^/]+/(src|tests|benches|examples)/.*\.rs$'); do
        lines=$(wc -l <"$file")
        [ "$lines" -le $LONGEST_SOURCE ] || echo "$file:$lines: longer than $LONGEST_SOURCE lines"
    done
}

# An exception to a lint says why.
check_exceptions() {
    local file
    for file in $(of '\.rs$'); do
        awk -v file="$file" '
            match($0, /^ *#!?\[(allow|expect)\(/) { open = 1; text = ""; first = FNR }
            open { text = text $0 }
            open && /\)\]/ { open = 0; if (text !~ /reason *=/) print file ":" first ": exception to a lint without a reason" }
        ' "$file"
    done
}

# Recorded data stays out of the repository, whoever may have copied it into the tree.
check_data() {
    local file
    for file in $(of '(\.csv\.gz|\.mat|\.bag|_imu\.csv|_mag\.csv|_truth\.csv|(^|/)trials\.csv)$'); do
        echo "$file:1: looks like recorded data, which is never committed"
    done
    for file in $files; do
        [ "$(wc -c <"$file")" -le $LARGEST_FILE ] || echo "$file:1: larger than $LARGEST_FILE bytes"
    done
}

breaches=$(check_links; check_lengths; check_exceptions; check_data)
if [ -n "$breaches" ]; then
    echo "$breaches"
    exit 1
fi
echo "links, file lengths, lint exceptions, data: fine ($(wc -l <<<"$files") files)"
