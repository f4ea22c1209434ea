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
python=/usr/bin/python3
echo "== fast against exact"
"$python" "$(dirname "$0")/held_out.py" "$build/palpate" "$build/bench-held-out"
echo "== heads"
"$python" "$(dirname "$0")/heads.py" "$build/palpate" "$build/bench-heads"
