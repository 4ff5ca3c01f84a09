#!/bin/sh
# Sets up what is needed and plans the example part.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh
exec .venv/bin/viewgauge plan examples/slotted_block/inspection.yaml -o examples/slotted_block/plan
