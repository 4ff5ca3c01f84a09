#!/bin/sh
# Sets up what is needed and passes the tests.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh dev
exec .venv/bin/python -m pytest -n auto --dist loadfile "$@"
