#!/bin/sh
# Passes the core's tests with another Python and plans the example with it, in an environment of its own:
#
#   sh scripts/test-core.sh python3.12
set -eu
cd "$(dirname "$0")/.."
python=${1:?usage: sh scripts/test-core.sh PYTHON}
place=.venv-$("$python" -c 'import sys; print("{}.{}".format(*sys.version_info))')
PYTHON=$python sh scripts/setup.sh test "$place"

# What takes long, or needs more than the extra `test`, stays with the whole suite.
"$place/bin/python" -m pytest -n auto --dist loadfile \
    tests/errors tests/geometry tests/evaluation tests/part tests/test_public_names.py \
    --ignore-glob='*/test_camera_errors.py' --ignore-glob='*/test_validity.py' --ignore-glob='*/test_budget.py'
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
"$place/bin/viewgauge" plan examples/slotted_block/inspection.yaml -o "$made"
