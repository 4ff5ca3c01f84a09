#!/bin/sh
# Sets up .venv beside this folder: viewgauge with all extras, in the versions that are tested. Run again at will.
set -eu
cd "$(dirname "$0")/.."

python=${PYTHON:-python3}
if ! "$python" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null; then
    echo "viewgauge needs Python 3.11, 3.12 or 3.13 as python3, or named by PYTHON=…; found: $("$python" --version 2>&1)" >&2
    exit 1
fi
if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
    echo "Python's venv module is missing; on Debian or Ubuntu: sudo apt-get install python3-venv" >&2
    exit 1
fi

# The CAD kernel links the system's OpenGL library, though it draws nothing.
if ! "$python" -c 'import ctypes; ctypes.CDLL("libGL.so.1")' 2>/dev/null; then
    install="apt-get install -y -q --no-install-recommends libgl1"
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
        echo "installing the system library libgl1"
        apt-get update -q >/dev/null && $install >/dev/null
    else
        echo "the system library libGL.so.1 is missing; on Debian or Ubuntu: sudo $install" >&2
        exit 1
    fi
fi

wanted=$("$python" -c '
import hashlib, pathlib, sys
files = b"".join(pathlib.Path(name).read_bytes() for name in ("pyproject.toml", "constraints.txt"))
print(hashlib.sha256(files + sys.version.encode()).hexdigest())')
if [ "$(cat .venv/installed 2>/dev/null)" != "$wanted" ]; then
    echo "setting up .venv (once; a few minutes)"
    "$python" -m venv --clear .venv
    .venv/bin/python -m pip install -q --disable-pip-version-check -c constraints.txt -e ".[dev]"
    echo "$wanted" >.venv/installed
fi
