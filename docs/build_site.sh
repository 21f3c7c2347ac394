#!/usr/bin/env bash
# Builds the site in build/docs: pages by MkDocs, drawings by Graphviz, the C++ reference by Doxygen.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

pages=build/docs-pages log=build/docs.log
rm -rf "$pages" build/docs
mkdir -p "$pages"
cp -r docs/*.md docs/pictures CONTRIBUTING.md CHANGELOG.md "$pages"
cp README.md "$pages/index.md"
# Here all pages are in one folder.
sed -i -E 's|\]\((\.\./)?docs/|](|g; s|\]\(\.\./README\.md|](index.md|g; s|\]\(\.\./([A-Z]+\.md)|](\1|g' \
  "$pages"/*.md
for drawing in docs/drawings/*.dot; do
  dot -Tsvg "$drawing" -o "$pages/pictures/$(basename "$drawing" .dot).svg"
done

mkdocs build >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
if grep 'contains a link' "$log" >&2; then exit 1; fi
doxygen docs/Doxyfile
printf '%s\n' "$PWD/build/docs/index.html"
