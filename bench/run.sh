#!/bin/sh
# Everything that `make bench` prints: the programs of bench/, then the figures head by head.
set -eu
build=$1
for program in "$build"/bench/bench_*; do
  [ -x "$program" ] || continue
  [ "$(basename "$program")" != bench_touch ] || continue  # make bench-touch
  echo "== $(basename "$program")"
  "$program"
done
echo "== heads"
python=/usr/bin/python3
"$python" "$(dirname "$0")/heads.py" "$build/palpate" "$build/bench-heads"
