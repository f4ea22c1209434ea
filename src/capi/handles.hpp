// SPDX-License-Identifier: Apache-2.0
// What the handles of palpate.h hold, and how errors become status codes.
#pragma once
#include <memory>
#include <new>
#include <string_view>

#include "capi/palpate.h"
#include "core/error.hpp"
#include "haptics/tick.hpp"

struct palpate_head {
  std::shared_ptr<const palpate::haptics::TouchModel> model;
};

struct palpate_touch {
  std::shared_ptr<const palpate::haptics::TouchModel> model;
  palpate::haptics::TickSetup setup;
  palpate::haptics::TickState state;
};

namespace palpate::capi {

/// Writes one line, cut to fit; `error` may be null. Returns the status.
palpate_status report(palpate_status status, std::string_view text, palpate_error* error) noexcept;

/// Runs `work` and turns whatever it throws into a status and a line.
template <class Work>
palpate_status guarded(palpate_error* error, Work&& work) noexcept {
  try {
    work();
    return report(PALPATE_OK, "", error);
  } catch (const InputError& e) {
    return report(PALPATE_BAD_INPUT, e.what(), error);
  } catch (const FileError& e) {
    return report(PALPATE_NO_FILE, e.what(), error);
  } catch (const std::bad_alloc&) {
    return report(PALPATE_NO_MEMORY, "out of memory", error);
  } catch (const std::exception& e) {
    return report(PALPATE_BUG, e.what(), error);
  } catch (...) {
    return report(PALPATE_BUG, "unknown exception", error);
  }
}

inline Vec3 vector(const double* v) {
  return {v[0], v[1], v[2]};
}
inline void put(const Vec3& v, double* out) {
  for (int k = 0; k < 3; ++k) out[k] = v[k];
}

}  // namespace palpate::capi
