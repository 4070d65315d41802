#!/bin/sh
# Formatting of every C and C++ file, the documentation of public headers, and (last, it takes by far the longest) lint
# of what was changed, or of every compiled file with ALL=1. Needs a configured tree. Who may include whom is a test
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
# A tree without united files, which has a command for each; nothing is compiled in it but generated headers.
separate=build/lint/tree
cmake --preset release -B "$separate" -DLCPBENCH_UNITE=OFF > build/lint/configure.log 2>&1 || { cat build/lint/configure.log >&2; exit 1; }
cmake --build "$separate" --target lcpbench_git_revision > /dev/null
# What is linted: all with ALL=1, else what differs from the commit that was linted as a whole last; of a header, the
# source of its name and one other that includes it.
all=$(git ls-files 'support/*.cc' 'model/*.cc' 'solvers/*.cc' 'benchmarks/*.cc' 'python/*.cc')
whole=$(cat .ci/linted)
if [ -n "${ALL:-}" ] || ! git cat-file -e "$whole^{commit}" 2> /dev/null || ! git diff --quiet "$whole" -- .clang-tidy "$pinned"; then
  files=$all
else
  files=$(git diff --name-only --diff-filter=d "$whole" | while read -r file; do
    case $file in
      tests/*) ;;
      *.cc) echo "$all" | grep -Fx "$file" || true ;;
      *.h) { echo "${file%.h}.cc"; git grep -lF "\"$file\"" -- '*.cc' ':!tests' ':!examples' | head -n 1; } | grep -Fx "$all" || true ;;
    esac
  done | sort -u)
fi
# The Python extension has a build of its own (make python-test).
for tree in "$separate" build/python; do
  [ -f "$tree/compile_commands.json" ] || continue
  lint=build/lint/$(basename "$tree")-commands
  mkdir -p "$lint"
  # clang does not know every option of GCC, nor its precompiled headers: without them every file must include what it uses.
  sed -e 's/ -fno-tree-loop-distribute-patterns//' -e 's/ -Winvalid-pch -include [^ ]*cmake_pch\.hxx//' "$tree/compile_commands.json" > "$lint/compile_commands.json"
  # Files of peers that are not installed are not compiled.
  echo "$files" | while read -r file; do
    if grep -q "\"file\": \"$PWD/$file\"" "$tree/compile_commands.json"; then echo "$file"; fi
  done | xargs -r -P "$(nproc)" -n 4 "$tidy" -p "$lint" --quiet --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-deprecated-declarations \
    --extra-arg=-Wreserved-identifier 2> build/clang-tidy.log || {
    echo "clang-tidy found something (see above)" >&2
    exit 1
  }
done
if [ "$files" = "$all" ] && [ -z "$(git status --porcelain --untracked-files=no)" ]; then git rev-parse HEAD > .ci/linted; fi
echo "formatting and documentation are clean, and lint of $(echo "$files" | grep -c .) of $(echo "$all" | grep -c .) files"
