#!/bin/sh
# Installs the browser that the tests of the workbench look at its pages with, where there is none.
set -eu
for name in chromium chromium-browser google-chrome chrome; do
    if command -v "$name" >/dev/null; then exit 0; fi
done
install="apt-get install -y -q --no-install-recommends chromium"
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing the browser chromium" >&2
    apt-get update -q >/dev/null && $install >/dev/null
else
    echo "no Chromium or Chrome: the tests of the workbench need one; on Debian or Ubuntu: sudo $install" >&2
    exit 1
fi
