// SPDX-License-Identifier: GPL-3.0-or-later
#include "serve/live_protocol.hpp"

#include <bit>
#include <cmath>
#include <cstring>

namespace palpate::serve {

static_assert(std::endian::native == std::endian::little, "messages are copied as they lie");

namespace {

template <class T>
T take(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

bool within(double value, double most) {
  return std::isfinite(value) && std::abs(value) <= most;
}

std::optional<Command> parse_press(std::string_view bytes) {
  if (bytes.size() != kLongestCommand) return {};
  const auto flags = take<std::uint32_t>(bytes, 4);
  if (flags > 1) return {};
  Command c;
  c.kind = Command::Kind::press;
  c.begin = flags == 1;
  for (int k = 0; k < 3; ++k) {
    c.point[k] = take<double>(bytes, 8 + 8 * static_cast<std::size_t>(k));
    if (!within(c.point[k], kFarthest)) return {};
  }
  c.depth = take<double>(bytes, 32);
  if (!within(c.depth, kDeepest)) return {};
  return c;
}

class Numbers {
 public:
  void add(double value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& m) {
    for (Eigen::Index row = 0; row < m.rows(); ++row)
      for (Eigen::Index column = 0; column < m.cols(); ++column) add(m(row, column));
  }
  [[nodiscard]] std::string message() const {
    std::string out = "PLST";
    put(out, kLiveVersion);
    put(out, static_cast<std::uint32_t>(bytes_.size() / sizeof(double)));
    put(out, std::uint32_t{0});
    return out + bytes_;
  }

 private:
  std::string bytes_;
};

unsigned flags_of(const haptics::TickOutput& out) {
  return (out.in_contact ? 1U : 0U) | (out.estimated ? 2U : 0U) | (out.clamped ? 4U : 0U) |
         (out.slewed ? 8U : 0U) | (out.finite ? 16U : 0U);
}

}  // namespace

std::optional<Command> parse_command(std::string_view bytes) {
  if (bytes.size() < 8) return {};
  const auto kind = take<std::uint32_t>(bytes, 0);
  if (kind == static_cast<std::uint32_t>(Command::Kind::press)) return parse_press(bytes);
  if (bytes.size() != 8) return {};
  const auto value = take<std::uint32_t>(bytes, 4);
  Command c;
  c.kind = static_cast<Command::Kind>(kind);
  switch (c.kind) {
    case Command::Kind::lift:
      return value == 0 ? std::optional(c) : std::nullopt;
    case Command::Kind::aim:
      if (value >= kSkinRegionNames.size()) return {};
      c.region = static_cast<SkinRegion>(value);
      return c;
    case Command::Kind::pause:
      if (value > 1) return {};
      c.on = value == 1;
      return c;
    default:
      return {};
  }
}

std::string command_bytes(const Command& c) {
  std::string bytes;
  put(bytes, static_cast<std::uint32_t>(c.kind));
  if (c.kind != Command::Kind::press) {
    put(bytes, c.kind == Command::Kind::aim     ? static_cast<std::uint32_t>(c.region)
               : c.kind == Command::Kind::pause ? std::uint32_t{c.on}
                                                : std::uint32_t{0});
    return bytes;
  }
  put(bytes, std::uint32_t{c.begin});
  for (int k = 0; k < 3; ++k) put(bytes, c.point[k]);
  put(bytes, c.depth);
  return bytes;
}

std::string state_bytes(const haptics::CycleSnapshot& s, const TouchedCurve& curve) {
  const haptics::TickOutput& out = s.out;
  Numbers n;
  n.add(1e-9 * static_cast<double>(s.time_ns));
  n.add(static_cast<double>(s.ticks));
  n.add(s.tool);
  n.add(out.force);
  n.add(out.normal);
  n.add(out.point);
  n.add(out.depth);
  n.add(out.map_force);
  n.add(out.stiffness);
  n.add(out.elastic);
  n.add(out.damped);
  n.add(out.weights);
  for (const std::int32_t v : out.vertices) n.add(v);
  n.add(static_cast<double>(out.region));
  n.add(flags_of(out));
  n.add(static_cast<double>(s.device));
  n.add(static_cast<double>(s.trip));
  n.add(s.buttons);
  n.add(s.balance);
  n.add(s.removed);
  n.add(s.user_force);
  n.add(s.workspace.rotation);
  n.add(s.workspace.at_head);
  n.add(s.workspace.scale);
  n.add(curve.deepest);
  for (const double f : curve.force) n.add(f);
  return n.message();
}

}  // namespace palpate::serve
