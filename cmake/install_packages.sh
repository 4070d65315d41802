#!/bin/sh
# Installs the Debian packages listed in the given file that are not there yet. Silent when nothing is missing.
set -eu
list=$1
mkdir -p build

packages=$(sed -e 's/#.*//' -e '/^[[:space:]]*$/d' "$list")
if ! command -v dpkg-query > /dev/null; then
  echo "This is not Debian: please provide the equivalents of" $packages >&2
  exit 0
fi

missing=
for package in $packages; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2> /dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

echo "Installing missing packages:$missing"
as_root=
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo > /dev/null || { echo "not root and no sudo: please install:$missing" >&2; exit 1; }
  as_root=sudo
fi
export DEBIAN_FRONTEND=noninteractive
$as_root apt-get update -qq
# shellcheck disable=SC2086  # one word per package is meant
$as_root apt-get install -y -qq --no-install-recommends $missing > build/packages.log 2>&1 || {
  tail -n 20 build/packages.log >&2
  echo "installing failed; the whole log is build/packages.log" >&2
  exit 1
}
