#!/bin/sh
# Sets up what a plan needs and plans the example part.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh plan
exec .venv/bin/viewgauge plan examples/slotted_block/inspection.yaml -o examples/slotted_block/plan
