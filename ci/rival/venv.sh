# Sourced by the scripts of ci: Pythons with the rivals, pinned, below the target folder. `rival_python` and `mealpy_python` are empty, after a
# word of why, where there is no python3. mealpy has a folder of its own: it wants a numpy before 2.
rival_python= mealpy_python=
rival_venv() { # FOLDER 'MODULES TO IMPORT' PACKAGES…: the folder's Python
    local venv=${CARGO_TARGET_DIR:-target}/$1 modules=$2
    shift 2
    [ -x "$venv/bin/python" ] || python3 -m venv "$venv"
    "$venv/bin/python" -c "import $modules" 2>/dev/null || "$venv/bin/pip" -q install "$@" >&2 || return
    echo "$(cd "$venv/bin" && pwd)/python"
}
if command -v python3 >/dev/null; then
    rival_python=$(rival_venv rival 'filterpy, numpy, vqf' 'numpy==2.*' 'filterpy==1.4.5' 'vqf==2.1.2')
    mealpy_python=$(rival_venv rival-mealpy 'mealpy' 'mealpy==3.0.*') || { mealpy_python= && echo "rivals: no mealpy, its numbers stay as they are" >&2; }
else
    echo "rivals: no python3, comparison left out" >&2
fi
