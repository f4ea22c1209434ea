// SPDX-License-Identifier: GPL-3.0-or-later
#define PALPATE_WIDTH 4
#define PALPATE_REGISTER "x"
#define PALPATE_KERNELS kBaseline
#define PALPATE_SPACE baseline
#include "fem/lanes/kernels.inc"
