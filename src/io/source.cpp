// SPDX-License-Identifier: Apache-2.0
#include "io/source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "core/error.hpp"

namespace palpate::io {

// Far above 20 M triangles in any of the formats but wordy ASCII STL (about 5 GB).
static constexpr std::size_t kMaxFileBytes = std::size_t{16} << 30;

void Source::fail(std::string_view where, std::string_view what, std::string_view remedy) const {
  throw InputError(where.empty() ? fmt::format("{}: {}; {}", name, what, remedy)
                                 : fmt::format("{}: {}: {}; {}", name, where, what, remedy));
}

namespace {
struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};
}  // namespace

std::string load_bytes(const std::filesystem::path& path) {
  const Source source{path.string(), {}, {}};
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (file.value < 0)
    source.fail("", fmt::format("cannot be opened ({})", std::strerror(errno)), "check the name");
  struct stat info {};
  if (::fstat(file.value, &info) != 0 || !S_ISREG(info.st_mode))
    source.fail("", "is not a regular file", "name a mesh file");
  if (info.st_size == 0) source.fail("", "the file is empty", "export the mesh again");
  const auto size = static_cast<std::size_t>(info.st_size);
  if (size > kMaxFileBytes) source.fail("", "is larger than 16 GiB", "decimate the mesh first");
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n = ::read(file.value, bytes.data() + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      source.fail("", fmt::format("cannot be read ({})", std::strerror(errno)), "check the disk");
    if (n == 0) source.fail("", "became shorter while it was read", "wait until it is written");
    done += static_cast<std::size_t>(n);
  }
  return bytes;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string out = "'";
  for (const char c : text.substr(0, kLongest)) out += (c >= ' ' && c <= '~') ? c : '?';
  return out + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace palpate::io
