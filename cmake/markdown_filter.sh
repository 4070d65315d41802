#!/bin/sh
# A Markdown file for Doxygen: links to a heading of a page become links to the page, which is all that it resolves.
sed 's/\.md#[a-z0-9-]*)/.md)/g' "$1"
