// SPDX-License-Identifier: GPL-3.0-or-later
#define PALPATE_WIDTH 16
#define PALPATE_REGISTER "v"
#define PALPATE_KERNELS kAvx512
#define PALPATE_SPACE avx512
#include "fem/lanes/kernels.inc"
