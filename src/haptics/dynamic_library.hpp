// SPDX-License-Identifier: Apache-2.0
// A vendor's library, looked for at run time.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::haptics {

/// Opens the first library of a list that loads, and takes functions out of it by name. What failed
/// can be told to people. Closed with the last copy.
class DynamicLibrary {
 public:
  /// @param names  file names or paths, tried in order
  explicit DynamicLibrary(std::span<const std::string> names);
  [[nodiscard]] bool loaded() const { return handle_ != nullptr; }
  [[nodiscard]] const std::string& name() const { return name_; }  ///< that was loaded
  /// Why nothing was loaded, or which functions are missing; empty when all is well.
  [[nodiscard]] std::string problem() const;

  /// Fills `function`; where the library lacks it, it stays null and problem() names it.
  template <class Function>
  void take(const char* symbol, Function*& function) {
    function = reinterpret_cast<Function*>(find(symbol, true));
  }
  /// The same for a function that is not needed.
  template <class Function>
  void take_if_there(const char* symbol, Function*& function) {
    function = reinterpret_cast<Function*>(find(symbol, false));
  }

 private:
  [[nodiscard]] void* find(const char* symbol, bool needed);

  std::shared_ptr<void> handle_;
  std::string name_, load_problem_;
  std::vector<std::string> missing_;
};

}  // namespace palpate::haptics
