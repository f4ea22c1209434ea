// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/checkpoint.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/atomic_file.hpp"
#include "core/error.hpp"

namespace palpate::stiffness {
namespace {

constexpr std::string_view kMagic = "PSB1";
constexpr std::uint32_t kHeader = 0x100;  // kind of the first block; solves are their SolveLevel
constexpr std::size_t kBlockHead = 4 + 4 + 4 + 8;
constexpr std::uint64_t kFormat = 2;

template <class T>
void append_bytes(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Reads values in order; `good` turns false where the bytes end too early.
struct Cursor {
  std::string_view bytes;
  bool good = true;
  template <class T>
  T take() {
    T value{};
    if (bytes.size() < sizeof value) {
      good = false;
      return value;
    }
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes.remove_prefix(sizeof value);
    return value;
  }
};

std::uint64_t hash_of(std::uint32_t kind, std::string_view payload) {
  Fingerprint f;
  const std::uint32_t head[2] = {kind, static_cast<std::uint32_t>(payload.size())};
  f.add(std::as_bytes(std::span(head)));
  f.add(std::as_bytes(std::span(payload)));
  return f.value();
}

std::string block(std::uint32_t kind, const std::string& payload) {
  std::string out(kMagic);
  append_bytes(out, kind);
  append_bytes(out, static_cast<std::uint32_t>(payload.size()));
  append_bytes(out, hash_of(kind, payload));
  return out + payload;
}

struct Block {
  std::uint32_t kind = 0;
  std::string_view payload;
};
/// The block at `at`, if it is whole.
bool whole_block(std::string_view bytes, std::size_t at, Block& out) {
  if (bytes.size() < at + kBlockHead || bytes.substr(at, 4) != kMagic) return false;
  Cursor head{bytes.substr(at + 4, kBlockHead - 4)};
  out.kind = head.take<std::uint32_t>();
  const auto size = head.take<std::uint32_t>();
  const auto hash = head.take<std::uint64_t>();
  if (bytes.size() - at - kBlockHead < size) return false;
  out.payload = bytes.substr(at + kBlockHead, size);
  return hash == hash_of(out.kind, out.payload);
}

}  // namespace

void Fingerprint::add(std::span<const std::byte> bytes) {
  for (const std::byte b : bytes) {
    hash_ ^= static_cast<std::uint64_t>(b);
    hash_ *= 0x100000001b3ULL;
  }
}

void Fingerprint::add(const std::string& text) {
  add(std::as_bytes(
      std::span(text.data(), text.size() + 1)));  // with the end: "ab","c" != "a","bc"
}

static std::string header_payload(std::uint64_t job) {
  std::string payload;
  append_bytes(payload, kFormat);
  append_bytes(payload, job);
  return payload;
}

Checkpoint::Checkpoint(std::filesystem::path path, std::uint64_t job) : path_(std::move(path)) {
  const auto refuse = [&](const std::string& what) {
    if (descriptor_ >= 0) ::close(descriptor_);
    throw FileError(fmt::format("checkpoint {}: {}", path_.string(), what));
  };
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (descriptor_ < 0) refuse(fmt::format("{}; name another file", std::strerror(errno)));
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
    refuse("another run is writing it; give each run its own file");
  try {
    const std::string header = block(kHeader, header_payload(job));
    const std::string bytes = read_file(path_);
    std::size_t whole = 0;
    if (bytes.size() >= header.size()) whole = read(path_, bytes, job);
    if (whole < bytes.size() && ::ftruncate(descriptor_, static_cast<off_t>(whole)) != 0)
      refuse(std::strerror(errno));
    if (whole == 0) append(header);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

Checkpoint::~Checkpoint() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Checkpoint::absorb(const std::filesystem::path& path, std::uint64_t job) {
  (void)read(path, read_file(path), job);
}

std::size_t Checkpoint::read(const std::filesystem::path& path, const std::string& bytes,
                             std::uint64_t job) {
  Block found;
  if (!whole_block(bytes, 0, found) || found.kind != kHeader)
    throw InputError(
        fmt::format("{}: not a checkpoint of a sweep, or its head is damaged; delete "
                    "it or name another file",
                    path.string()));
  if (found.payload != header_payload(job))
    throw InputError(
        fmt::format("{}: belongs to another head, other options, another version or "
                    "another instruction set; delete it or name another file",
                    path.string()));
  std::size_t at = kBlockHead + found.payload.size();
  while (at < bytes.size()) {
    if (whole_block(bytes, at, found)) {
      take(static_cast<SolveLevel>(found.kind), found.payload);
      at += kBlockHead + found.payload.size();
      continue;
    }
    std::size_t next = bytes.find(kMagic, at + 1);
    while (next != std::string::npos && !whole_block(bytes, next, found))
      next = bytes.find(kMagic, next + 1);
    if (next == std::string::npos) return at;  // cut off while it was written
    damage_.push_back(
        fmt::format("{}: bytes {} to {} are damaged; what they held is computed again",
                    path.string(), at, next));
    at = next;
  }
  return at;
}

void Checkpoint::take(SolveLevel level, std::string_view payload) {
  Cursor c{payload};
  const auto count = c.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && c.good; ++i) {
    const auto site = c.take<std::int32_t>();
    SiteCurve curve;
    curve.method = c.take<SolveMethod>();
    curve.bent = c.take<std::uint8_t>() != 0;
    curve.iterations = c.take<std::int32_t>();
    curve.projections = c.take<std::int32_t>();
    curve.residual = c.take<double>();
    curve.travel.resize(c.take<std::uint32_t>());
    for (double& u : curve.travel) u = c.take<double>();
    curve.sunk.resize(c.take<std::uint32_t>());
    for (double& w : curve.sunk) w = c.take<double>();
    curve.published.resize(c.take<std::uint32_t>());
    for (fem::PublishedSample& p : curve.published) {
      p.displacement = c.take<double>();
      p.at_rest = c.take<std::uint8_t>() != 0;
      p.inverted_tets = c.take<std::int32_t>();
      p.steps = c.take<std::int32_t>();
    }
    if (c.good) curves_[{level, site}] = std::move(curve);
  }
}

const SiteCurve* Checkpoint::find(SolveLevel level, std::int32_t site) const {
  const std::lock_guard lock(mutex_);
  const auto at = curves_.find({level, site});
  return at == curves_.end() ? nullptr : &at->second;
}

std::size_t Checkpoint::size() const {
  const std::lock_guard lock(mutex_);
  return curves_.size();
}

void Checkpoint::put(SolveLevel level, std::span<const std::int32_t> sites,
                     std::span<const SiteCurve> curves) {
  std::string payload;
  append_bytes(payload, static_cast<std::uint32_t>(sites.size()));
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const SiteCurve& c = curves[i];
    append_bytes(payload, sites[i]);
    append_bytes(payload, c.method);
    append_bytes(payload, static_cast<std::uint8_t>(c.bent));
    append_bytes(payload, static_cast<std::int32_t>(c.iterations));
    append_bytes(payload, static_cast<std::int32_t>(c.projections));
    append_bytes(payload, c.residual);
    for (const std::vector<double>* list : {&c.travel, &c.sunk}) {
      append_bytes(payload, static_cast<std::uint32_t>(list->size()));
      for (const double v : *list) append_bytes(payload, v);
    }
    append_bytes(payload, static_cast<std::uint32_t>(c.published.size()));
    for (const fem::PublishedSample& p : c.published) {
      append_bytes(payload, p.displacement);
      append_bytes(payload, static_cast<std::uint8_t>(p.at_rest));
      append_bytes(payload, static_cast<std::int32_t>(p.inverted_tets));
      append_bytes(payload, static_cast<std::int32_t>(p.steps));
    }
  }
  const std::lock_guard lock(mutex_);
  if (descriptor_ >= 0) append(block(static_cast<std::uint32_t>(level), payload));
  for (std::size_t i = 0; i < sites.size(); ++i) curves_[{level, sites[i]}] = curves[i];
}

void Checkpoint::append(const std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      throw FileError(
          fmt::format("checkpoint {}: {}; {} curves before this are safe, free space "
                      "and run the same command again",
                      path_.string(), std::strerror(n < 0 ? errno : ENOSPC), curves_.size()));
    done += static_cast<std::size_t>(n);
  }
  ::fdatasync(descriptor_);
}

}  // namespace palpate::stiffness
