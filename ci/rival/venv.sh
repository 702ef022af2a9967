# Sourced by the scripts of ci: a Python with the rivals, pinned, below the target folder. `rival_python` is empty, after a
# word of why, where there is no python3.
rival_python=
if command -v python3 >/dev/null; then
    venv=${CARGO_TARGET_DIR:-target}/rival
    [ -x "$venv/bin/python" ] || python3 -m venv "$venv"
    "$venv/bin/python" -c 'import filterpy, numpy, vqf' 2>/dev/null ||
        "$venv/bin/pip" -q install 'numpy==2.*' 'filterpy==1.4.5' 'vqf==2.1.2'
    rival_python=$(cd "$venv/bin" && pwd)/python
else
    echo "rivals: no python3, comparison left out" >&2
fi
