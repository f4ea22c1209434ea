// SPDX-License-Identifier: Apache-2.0
#include "haptics/dynamic_library.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace palpate::haptics {

DynamicLibrary::DynamicLibrary(std::span<const std::string> names) {
  std::string broken;
  for (const std::string& name : names) {
    if (void* handle = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL)) {
      handle_ = std::shared_ptr<void>(handle, [](void* h) { dlclose(h); });
      name_ = name;
      return;
    }
    // A library that is there but does not load deserves its own words; the loader names the file
    // it misses, which is this one when the library itself is absent.
    const char* why = dlerror();
    if (why && broken.empty() && !std::string_view(why).starts_with(name + ": cannot open"))
      broken = why;
  }
  load_problem_ = broken.empty()
                      ? fmt::format("library not found (looked for {})", fmt::join(names, ", "))
                      : fmt::format("library does not load ({})", broken);
}

void* DynamicLibrary::find(const char* symbol, bool needed) {
  void* address = handle_ ? dlsym(handle_.get(), symbol) : nullptr;
  if (!address && needed && handle_) missing_.emplace_back(symbol);
  return address;
}

std::string DynamicLibrary::problem() const {
  if (!handle_) return load_problem_;
  if (missing_.empty()) return {};
  return fmt::format("{} lacks {}: another version is needed", name_, fmt::join(missing_, ", "));
}

}  // namespace palpate::haptics
