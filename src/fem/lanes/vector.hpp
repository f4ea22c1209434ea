// SPDX-License-Identifier: GPL-3.0-or-later
// A short vector of floats for the kernels, of the width that the instruction set likes; only
// compiler built-ins. Included by kernels.inc inside each instruction set's namespace.
typedef float V __attribute__((vector_size(PALPATE_WIDTH * 4), may_alias));
typedef std::int32_t VI __attribute__((vector_size(PALPATE_WIDTH * 4), may_alias));
constexpr int kWidth = PALPATE_WIDTH;

static inline V load(const float* p) {
  return *reinterpret_cast<const V*>(p);
}
static inline void store(float* p, V v) {
  *reinterpret_cast<V*>(p) = v;
}
static inline void keep_in_register(V& v) {
  asm("" : "+" PALPATE_REGISTER(v));
}
static inline V broadcast(float f) {
  return V{} + f;
}
/// m ? a : b, lane by lane; m is 0 or -1.
static inline V select(VI m, V a, V b) {
  return (V)((m & (VI)a) | (~m & (VI)b));
}
static inline bool any(VI m) {
  std::int32_t sum = 0;
  for (int i = 0; i < kWidth; ++i) sum |= m[i];
  return sum != 0;
}
static inline V square_root(V v) {
  V out;
  for (int i = 0; i < kWidth; ++i) out[i] = __builtin_sqrtf(v[i]);
  return out;
}
/// ln x for x > 0: x = 2^e m with m in [sqrt(1/2), sqrt(2)), then 2 artanh((m - 1)/(m + 1)) as a
/// series; relative error below 3e-7.
static inline V logarithm(V x) {
  const VI bits = (VI)x;
  VI e = (bits - 0x3f3504f3) >> 23;  // 0x3f3504f3 is sqrt(1/2)
  const V m = (V)(bits - (e << 23));
  const V s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
  V p = broadcast(2.0f / 11);
  p = p * s2 + 2.0f / 9;
  p = p * s2 + 2.0f / 7;
  p = p * s2 + 2.0f / 5;
  p = p * s2 + 2.0f / 3;
  p = p * s2 + 2.0f;
  V ef;
  for (int i = 0; i < kWidth; ++i) ef[i] = static_cast<float>(e[i]);
  return ef * 0.69314718f + s * p;
}
