// SPDX-License-Identifier: GPL-3.0-or-later
#define PALPATE_WIDTH 8
#define PALPATE_REGISTER "x"
#define PALPATE_KERNELS kAvx2
#define PALPATE_SPACE avx2
#include "fem/lanes/kernels.inc"
