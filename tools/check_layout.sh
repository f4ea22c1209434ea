#!/bin/sh
# Holds the include lines under src/ against the table "folder may include folder".
# Prints each violation as file:line; exit 1 where there is one.
set -eu
cd "$(dirname "$0")/.."
awk '
BEGIN {
  allow["core"] = ""
  n = split("io surface fem haptics study plot", a); for (i = 1; i <= n; i++) allow[a[i]] = "core"
  n = split("landmarks registration tetmesh image", a); for (i = 1; i <= n; i++) allow[a[i]] = "core surface"
  allow["skull"] = "core surface registration"
  allow["stiffness"] = "core surface tetmesh fem"
  allow["report"] = "core surface plot"
  allow["verify"] = "core surface tetmesh fem stiffness plot report"
  allow["serve"] = "core haptics study plot"
  allow["capi"] = "core io haptics"
}
/^[ \t]*#[ \t]*include[ \t]*"/ {
  split(FILENAME, path, "/"); folder = path[2]
  if (!(folder in allow)) { printf "%s: folder %s is not in the table\n", FILENAME, folder; bad = 1; nextfile }
  split($0, quoted, "\""); split(quoted[2], part, "/"); target = part[1]
  if (quoted[2] !~ /\//) { printf "%s:%d: write the include with its folder: %s\n", FILENAME, FNR, quoted[2]; bad = 1 }
  else if (target != folder && index(" " allow[folder] " ", " " target " ") == 0) {
    printf "%s:%d: %s may not include %s (may: %s)\n", FILENAME, FNR, folder, target, allow[folder]; bad = 1
  }
}
FNR == 1 && /SPDX-License-Identifier/ {
  split(FILENAME, path, "/"); folder = path[2]
  permissive = (folder == "core" || folder == "io" || folder == "haptics" || folder == "capi")
  if (permissive != ($0 ~ /Apache-2.0/)) { printf "%s:1: wrong licence line for folder %s\n", FILENAME, folder; bad = 1 }
}
FNR == 1 && !/SPDX-License-Identifier/ { printf "%s:1: no SPDX-License-Identifier line\n", FILENAME; bad = 1 }
END { if (bad) exit 1; print "layout: every include keeps to the table" }
' $(find src -name '*.hpp' -o -name '*.cpp' -o -name '*.h' | sort)
