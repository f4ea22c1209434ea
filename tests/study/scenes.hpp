// SPDX-License-Identifier: GPL-3.0-or-later
// Small studies for tests.
#pragma once
#include <unistd.h>

#include <filesystem>

#include "core/atomic_file.hpp"
#include "study/run.hpp"
#include "study/store.hpp"

namespace palpate::study::scenes {

inline std::string published_text() {
  return read_file(std::filesystem::path(PALPATE_SOURCE_DIR) / "protocols" /
                   "head-stiffness-2015.toml");
}
inline Protocol published() {
  return parse_protocol(published_text(), "head-stiffness-2015.toml");
}
inline Protocol discrimination() {
  return read_protocol(std::filesystem::path(PALPATE_SOURCE_DIR) / "protocols" /
                       "stiffness-discrimination.toml");
}

/// Regions in the protocol's order with stiffness falling as in the published one.
inline Study study_of(const Protocol& p, std::uint64_t seed = 1) {
  Study s;
  s.id = "00112233445566778899aabbccddeeff";
  s.title = p.title;
  s.protocol_name = p.name;
  s.protocol_text = p.text;
  s.head_name = "head.glb";
  s.head_fingerprint = "0123456789abcdef";
  s.tool_radius = 8;
  s.seed = seed;
  s.program = "palpate test";
  s.created = now();
  s.planned_participants = p.participants;
  const std::vector<std::string> stiff = {"cranium", "forehead", "eyebrow", "cheekbone",
                                          "jaw",     "chin",     "cheek"};
  for (const std::string& name : p.regions) {
    StudyRegion r;
    r.name = name;
    for (std::size_t i = 0; i < stiff.size(); ++i)
      if (stiff[i] == name) r.stiffness = r.stiffness_at_point = 2.0 / static_cast<double>(1 + i);
    s.regions.push_back(r);
  }
  return s;
}

/// Answers anything sensible.
inline std::string some_answer(const Screen& s) {
  switch (s.kind) {
    case ScreenKind::consent:
      return "given";
    case ScreenKind::question:
      if (s.question.type == QuestionType::choice) return s.question.options.front().id;
      if (s.question.type == QuestionType::text) return "beside the nose";
      return std::to_string(static_cast<int>(s.question.least + 4 * s.question.step));
    case ScreenKind::choose:
      return s.barred.empty() ? "1,2" : "3,4";
    default:
      return "done";
  }
}

class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() /
              ("palpate_study_" + std::to_string(getpid()) + "_" + std::to_string(++count()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  static int& count() {
    static int n = 0;
    return n;
  }
  std::filesystem::path path_;
};

}  // namespace palpate::study::scenes
