#!/bin/sh
# Formatting of every C and C++ file, the documentation of public headers, and (last, it takes by far the longest) lint
# of every compiled file. Needs a configured and built tree (its generated headers). Who may include whom is a test
# (tests/house_test.py).
set -eu
build=$1
git ls-files '*.h' '*.cc' '*.c' | xargs clang-format --dry-run -Werror
if ! cmake --build "$build" --target doc > build/doc.log 2>&1; then
  cat build/doc.log >&2
  exit 1
fi
mkdir -p build/lint
tidy=build/lint/bin/clang-tidy
pinned=cmake/packages/requirements-lint.txt
if ! { [ -x "$tidy" ] && [ ! "$pinned" -nt "$tidy" ]; }; then
  { /usr/bin/python3 -m venv build/lint && build/lint/bin/pip install -q --force-reinstall -r "$pinned"; } \
    > build/lint/install.log 2>&1 && touch "$tidy" || {
    echo "no clang-tidy from PyPI (build/lint/install.log): Debian's does it, which takes five times as long"
    tidy=clang-tidy
  }
fi
# The Python extension has a build of its own (make python-test).
for tree in "$build" build/python; do
  [ -f "$tree/compile_commands.json" ] || continue
  lint=build/lint/$(basename "$tree")
  mkdir -p "$lint"
  # clang does not know every option of GCC, nor its precompiled headers: without them every file must include what it uses.
  sed -e 's/ -fno-tree-loop-distribute-patterns//' -e 's/ -Winvalid-pch -include [^ ]*cmake_pch\.hxx//' "$tree/compile_commands.json" > "$lint/compile_commands.json"
  # Files of peers that are not installed are not compiled.
  git ls-files 'support/*.cc' 'model/*.cc' 'solvers/*.cc' 'benchmarks/*.cc' 'python/*.cc' | while read -r file; do
    if grep -q "\"file\": \"$PWD/$file\"" "$tree/compile_commands.json"; then echo "$file"; fi
  done | xargs -r -P "$(nproc)" -n 4 "$tidy" -p "$lint" --quiet --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-deprecated-declarations \
    --extra-arg=-Wreserved-identifier 2> build/clang-tidy.log || {
    echo "clang-tidy found something (see above)" >&2
    exit 1
  }
done
echo "formatting, lint and documentation are clean"
