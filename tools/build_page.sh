#!/bin/sh
# Builds the page: tools/build_page.sh WEB_SOURCE OUTPUT_FOLDER
# Where Node.js, npm or the packages cannot be had, it says so in one line and succeeds: everything
# but the page works without it.
set -eu
source=$1
output=$2
skip() {
  echo "page: not built, $1; everything else works"
  exit 0
}
command -v node >/dev/null 2>&1 || skip "node is not installed (apt-get install nodejs npm)"
command -v npm >/dev/null 2>&1 || skip "npm is not installed (apt-get install npm)"
cd "$source"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# The packages of the lock file, once; a stamp tells whether they are those.
if ! cmp -s package-lock.json node_modules/.palpate-lock 2>/dev/null; then
  npm install --no-save --fetch-retries=1 --fetch-timeout=30000 --loglevel=error >"$log" 2>&1 ||
    skip "npm could not fetch its packages ($(grep -v '^$' "$log" | head -n 1))"
  cp package-lock.json node_modules/.palpate-lock
fi
if ! { node_modules/.bin/tsc --noEmit && node_modules/.bin/vite build --outDir "$output" --emptyOutDir --logLevel warn; } >"$log" 2>&1; then
  cat "$log" >&2
  exit 1
fi
touch "$output/.built"
echo "page: $output"
