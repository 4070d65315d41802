#!/bin/sh
# install_wheels.sh PYTHON FILE FOLDER: the wheels that FILE pins, in an environment of their own. Where no package
# index can be reached, says so and goes on: what needs them is then not in the build.
set -e
python=$1
file=$2
folder=$3
if [ -f "$folder/installed.txt" ] && cmp -s "$file" "$folder/installed.txt"; then exit 0; fi
[ -x "$folder/bin/python" ] || "$python" -m venv "$folder"
echo "installing wheels: $file into $folder"
if "$folder/bin/python" -m pip install --quiet --disable-pip-version-check --no-input --only-binary :all: -r "$file"; then
  cp "$file" "$folder/installed.txt"
else
  echo "the wheels of $file could not be installed: peers of PyPI are not in this build"
fi
