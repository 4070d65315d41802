#!/bin/sh
# A Markdown file for Doxygen, which resolves links to pages but not to headings, and writes formulas in its own way. (A
# page without a command of LaTeX between $ has none: $ is a dollar there.)
if grep -q '\$[^$`]*\\[a-z]' "$1"; then
  formulas='s/\$([^$]+)\$/\\f$\1\\f$/g; /^```math$/,/^```$/{ s/^```math$/\\f[/; s/^```$/\\f]/; }'
fi
sed -E -e 's/\.md#[a-z0-9-]*\)/.md)/g; s/\[([^]]*)\]\(#[a-z0-9-]*\)/\1/g' -e "${formulas:-}" "$1"
