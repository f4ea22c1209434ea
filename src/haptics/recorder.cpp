// SPDX-License-Identifier: Apache-2.0
#include "haptics/recorder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "core/error.hpp"
#include "haptics/recording_codec.hpp"

namespace palpate::haptics {

Recorder::Recorder(const std::filesystem::path& path, const TickSetup& setup,
                   const std::string& device, double rate_hz)
    : path_(path), slots_(std::make_unique<std::array<Slot, kBlocks>>()) {
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file_ < 0)
    throw FileError(fmt::format("cannot record to {}: {}", path.string(), std::strerror(errno)));
  RecordingHeader header;
  header.fingerprint = setup.model->fingerprint;
  header.tool_radius = setup.model->tool_radius;
  header.limits = setup.limits;
  header.device = device;
  header.options = setup.options;
  header.rate_hz = rate_hz;
  append(codec::encode_header(header));
  if (errno_ != 0) {
    ::close(file_);
    throw FileError(error());
  }
  for (std::size_t i = 0; i < kBlocks; ++i) empty_.push(i);
  writer_ = std::thread([this] { write_blocks(); });
}

Recorder::~Recorder() {
  try {
    finish();
  } catch (const FileError&) {
    // A destructor must not throw; finish() tells those who ask.
  }
}

std::string Recorder::error() const {
  const int e = errno_.load();
  return e ? fmt::format("recording to {} failed: {}", path_.string(), std::strerror(e))
           : std::string();
}

void Recorder::before_tick(const TickState& state) noexcept {
  if (current_ != kBlocks) return;
  std::size_t next = 0;
  if (!empty_.pop(next)) {
    ++lost_;
    dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    return;
  }
  current_ = next;
  Slot& slot = (*slots_)[next];
  slot.state = state;
  slot.count = 0;
  slot.dropped = lost_;
  lost_ = 0;
}

void Recorder::after_tick(const TickInput& input, const TickOutput& out,
                          const TickNotes& notes) noexcept {
  if (current_ == kBlocks) return;
  Slot& slot = (*slots_)[current_];
  RecordedTick& t = slot.ticks[slot.count++];
  t.input = input;
  t.force = out.force;
  t.depth = out.depth;
  t.map_force = out.map_force;
  t.time_ns = notes.time_ns;
  t.late_ns = notes.late_ns;
  t.buttons = notes.buttons;
  t.trip = notes.trip;
  t.region = out.region;
  t.in_contact = out.in_contact;
  if (slot.count < kTicksPerBlock) return;
  full_.push(current_);  // never full: it has a place for every slot
  current_ = kBlocks;
}

void Recorder::write_blocks() {
  constexpr std::chrono::milliseconds kLook{20};  // a block lasts 25 times as long
  for (;;) {
    const bool last = stop_.load(std::memory_order_acquire);
    std::size_t slot = 0;
    while (full_.pop(slot)) {
      write_slot((*slots_)[slot]);
      empty_.push(slot);
    }
    if (last) return;
    std::this_thread::sleep_for(kLook);
  }
}

void Recorder::write_slot(const Slot& slot) {
  RecordedBlock block;
  block.state = slot.state;
  block.dropped = slot.dropped;
  block.ticks.assign(slot.ticks.begin(),
                     slot.ticks.begin() + static_cast<std::ptrdiff_t>(slot.count));
  append(codec::framed(codec::encode_block(block)));
  if (errno_ != 0) return;
  ::fdatasync(file_);
  written_.store(written_.load(std::memory_order_relaxed) + slot.count, std::memory_order_relaxed);
}

// After a failure nothing more is written: a block behind a hole could not be found again.
void Recorder::append(const std::string& bytes) {
  if (errno_ != 0) return;
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(file_, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      errno_ = n < 0 ? errno : EIO;
      return;
    }
    done += static_cast<std::size_t>(n);
  }
}

void Recorder::finish() {
  if (file_ < 0) return;
  if (current_ != kBlocks && (*slots_)[current_].count > 0) full_.push(current_);
  current_ = kBlocks;
  stop_.store(true, std::memory_order_release);
  writer_.join();
  if (::close(file_) != 0 && errno_ == 0) errno_ = errno;
  file_ = -1;
  if (errno_ != 0) throw FileError(error());
}

}  // namespace palpate::haptics
