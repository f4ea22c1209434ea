// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a head in closed form with seven regions:  write_study_head OUT.glb
#include "io/head_file.hpp"
#include "study/study_head.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  palpate::io::write_head(argv[1], palpate::study::scenes::seven_regions(40));
}
