#!/bin/sh
# Sets up an environment beside this folder, in the versions that are tested. Run again at will: what is there stays.
#
#   sh scripts/setup.sh plan            what a plan needs: the core and the CAD kernel
#   sh scripts/setup.sh test            and what the core's tests need
#   sh scripts/setup.sh dev             and everything else: all extras, documentation, tools
#   sh scripts/setup.sh test .venv-3.12   elsewhere than in .venv
#
# PYTHON names the interpreter to use in place of python3.
set -eu
cd "$(dirname "$0")/.."

say() { echo "$*" >&2; }

python=${PYTHON:-python3}
what=${1:-dev}
place=${2:-.venv}
case $what in # each holds those before it
    plan) extras=step enough="plan test dev" holds="what a plan needs (about a minute, 1 GB)" ;;
    test) extras=step,test enough="test dev" holds="what the core's tests need (about a minute, 1 GB)" ;;
    dev) extras=dev enough="dev" holds="all extras and tools (a few minutes, 2.2 GB)" ;;
    *) say "usage: sh scripts/setup.sh plan|test|dev [FOLDER]"; exit 2 ;;
esac

if ! "$python" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null; then
    say "viewgauge needs Python 3.11, 3.12 or 3.13 as python3, or named by PYTHON=…; found: $("$python" --version 2>&1)"
    exit 1
fi
if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
    say "Python's venv module is missing; on Debian or Ubuntu: sudo apt-get install python3-venv"
    exit 1
fi

# The CAD kernel links the system's OpenGL library, though it draws nothing.
if ! "$python" -c 'import ctypes; ctypes.CDLL("libGL.so.1")' 2>/dev/null; then
    install="apt-get install -y -q --no-install-recommends libgl1"
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
        say "installing the system library libgl1"
        apt-get update -q >/dev/null && $install >/dev/null
    else
        say "the system library libGL.so.1 is missing; on Debian or Ubuntu: sudo $install"
        exit 1
    fi
fi

# An environment is up to date when these are what they were; where it lies is written into its commands.
wanted=$("$python" -c '
import hashlib, os, pathlib, sys
files = b"".join(pathlib.Path(name).read_bytes() for name in ("pyproject.toml", "constraints.txt"))
print(hashlib.sha256(files + sys.version.encode() + os.getcwdb()).hexdigest())')
if [ ! -e "$place/unfinished" ]; then
    for made in $enough; do
        if [ "$(cat "$place/installed-$made" 2>/dev/null)" = "$wanted" ]; then exit 0; fi
    done
fi

# One that lacks pip, is of another Python or was interrupted while it was made is made anew; others are added to.
version='import sys; print(sys.version)'
if [ -e "$place/unfinished" ] ||
    [ "$("$place/bin/python" -c "import pip; $version" 2>/dev/null)" != "$("$python" -c "$version")" ]; then
    say "making the environment $place"
    "$python" -m venv --clear "$place"
fi
trap 'exit 130' INT TERM
: >"$place/unfinished"
say "installing viewgauge and $holds into $place"
"$place/bin/python" -m pip install -q --disable-pip-version-check --no-compile -c constraints.txt -e ".[$extras]" || {
    rm "$place/unfinished" # pip took back what it had begun
    exit 1
}
# In place of pip's own compiling: on all processors, and without what no command ever imports, a tenth of the size.
say "compiling the installed Python files"
"$place/bin/python" -m compileall -q -j 0 \
    -x '/(tests?|testing|_tests|validators|lexers|cuda|pip|setuptools|pkg_resources|graph_objs/[^/]+)/' \
    "$("$place/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')" >/dev/null || true
rm "$place/unfinished"
echo "$wanted" >"$place/installed-$what"
