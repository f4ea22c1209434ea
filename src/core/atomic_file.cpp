// SPDX-License-Identifier: Apache-2.0
#include "core/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "core/error.hpp"

namespace palpate {
namespace fs = std::filesystem;

static std::string reason() {
  return std::strerror(errno);
}

namespace {
/// Removes the temporary file unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target)
      : path_(target.parent_path() /
              fmt::format(".{}.{}.part", target.filename().string(), getpid())) {
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (descriptor_ < 0)
      throw FileError(fmt::format("{}: cannot write here ({}); choose another output folder",
                                  target.string(), reason()));
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!renamed_) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::string_view bytes, const fs::path& target) {
    while (!bytes.empty()) {
      const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) fail(target);
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }
  void commit(const fs::path& target) {
    if (::fsync(descriptor_) != 0 && errno != EINVAL) fail(target);
    const int d = descriptor_;
    descriptor_ = -1;
    if (::close(d) != 0) fail(target);
    if (::rename(path_.c_str(), target.c_str()) != 0) fail(target);
    renamed_ = true;
  }

 private:
  [[noreturn]] static void fail(const fs::path& target) {
    throw FileError(fmt::format("{}: writing failed ({}); free some space or choose another folder",
                                target.string(), reason()));
  }
  fs::path path_;
  int descriptor_ = -1;
  bool renamed_ = false;
};
}  // namespace

void write_file(const fs::path& path, std::string_view bytes) {
  TemporaryFile file(path);
  file.write(bytes, path);
  file.commit(path);
}

void write_file(const fs::path& path, const std::function<void(std::ostream&)>& writer) {
  std::ostringstream text;
  writer(text);
  write_file(path, text.view());
}

std::string read_file(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error))
    throw InputError(fmt::format("{}: is a folder; name a file", path.string()));
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw InputError(
        fmt::format("{}: cannot be opened ({}); check the name", path.string(), reason()));
  std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (in.bad()) throw InputError(fmt::format("{}: cannot be read ({})", path.string(), reason()));
  return bytes;
}

}  // namespace palpate
