// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/figure.hpp"

namespace palpate::verify {

const char* name(Verdict v) {
  switch (v) {
    case Verdict::met:
      return "met";
    case Verdict::missed:
      return "MISSED";
    default:
      return "not run";
  }
}

Figure at_most(std::string what, double value, double limit, std::string note) {
  return {std::move(what), value, limit, false, value <= limit ? Verdict::met : Verdict::missed,
          std::move(note)};
}

Figure at_least(std::string what, double value, double limit, std::string note) {
  return {std::move(what), value, limit, true, value >= limit ? Verdict::met : Verdict::missed,
          std::move(note)};
}

Figure not_run(std::string what, double limit, std::string reason) {
  return {std::move(what), 0, limit, false, Verdict::not_run, std::move(reason)};
}

}  // namespace palpate::verify
