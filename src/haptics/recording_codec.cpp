// SPDX-License-Identifier: Apache-2.0
#include "haptics/recording_codec.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <type_traits>

namespace palpate::haptics::codec {

namespace {

constexpr std::array<std::uint32_t, 256> make_crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320U ^ (c >> 1) : c >> 1;
    table[i] = c;
  }
  return table;
}
constexpr auto kCrcTable = make_crc_table();

// Words 0 and 1 are times, which grow by nearly equal steps; their difference is stored instead of
// their exclusive or, zigzag so that small negative ones are short too.
constexpr int kTimes = 2;
std::uint64_t change(int word, std::uint64_t from, std::uint64_t to) {
  if (word >= kTimes) return from ^ to;
  const auto d = static_cast<std::int64_t>(to - from);
  return (static_cast<std::uint64_t>(d) << 1) ^ static_cast<std::uint64_t>(d >> 63);
}
std::uint64_t apply(int word, std::uint64_t from, std::uint64_t c) {
  if (word >= kTimes) return from ^ c;
  return from + ((c >> 1) ^ (~(c & 1) + 1));
}

std::uint64_t bits(double x) {
  return std::bit_cast<std::uint64_t>(x);
}
double real(std::uint64_t w) {
  return std::bit_cast<double>(w);
}

// Every member of a state in a fixed order. Members added later change the format's version.
template <class State, class Visit>
void each_member(State& s, Visit visit) {
  const auto vector = [&](auto& v) {
    for (int k = 0; k < 3; ++k) visit(v[k]);
  };
  vector(s.proxy.anchor.on.point);
  vector(s.proxy.anchor.on.barycentric);
  visit(s.proxy.anchor.on.feature);
  visit(s.proxy.anchor.triangle);
  visit(s.proxy.anchor.distance2);
  vector(s.proxy.center);
  visit(s.proxy.clearance);
  visit(s.proxy.started);
  visit(s.proxy.touching);
  visit(s.proxy.from_inside);
  vector(s.position);
  vector(s.mean);
  vector(s.tool);
  vector(s.velocity);
  vector(s.force);
  vector(s.asked);
  vector(s.settled.normal);
  visit(s.settled.force);
  visit(s.settled.depth);
  visit(s.settled.stiffness);
  for (auto& corner : s.settled.corners) visit(corner);
  vector(s.settled.weights);
  vector(s.shear);
  visit(s.slip);
  visit(s.ramp);
  visit(s.balance);
  visit(s.generated);
  visit(s.removed);
  visit(s.ticks);
  visit(s.started);
  visit(s.in_contact);
}

}  // namespace

std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t c = 0xffffffffU;
  for (const char b : bytes) c = kCrcTable[(c ^ static_cast<unsigned char>(b)) & 0xffU] ^ (c >> 8);
  return ~c;
}

TickWords to_words(const RecordedTick& t) {
  TickWords w{};
  w[0] = static_cast<std::uint64_t>(t.time_ns);
  w[1] = static_cast<std::uint64_t>(t.late_ns);
  w[2] = static_cast<std::uint64_t>(t.buttons) << 32 | static_cast<std::uint64_t>(t.trip) << 16 |
         static_cast<std::uint64_t>(t.region) << 8 | (t.input.has_velocity ? 1U : 0U) |
         (t.input.hold ? 2U : 0U) | (t.in_contact ? 4U : 0U);
  w[3] = bits(t.input.dt);
  for (int k = 0; k < 3; ++k) {
    w[4 + k] = bits(t.input.position[k]);
    w[7 + k] = bits(t.input.velocity[k]);
    w[10 + k] = bits(t.force[k]);
  }
  w[13] = bits(t.depth);
  w[14] = bits(t.map_force);
  return w;
}

RecordedTick from_words(const TickWords& w) {
  RecordedTick t;
  t.time_ns = static_cast<std::int64_t>(w[0]);
  t.late_ns = static_cast<std::int64_t>(w[1]);
  t.buttons = static_cast<std::uint32_t>(w[2] >> 32);
  t.trip = static_cast<std::uint8_t>(w[2] >> 16);
  const auto region = static_cast<std::uint8_t>(w[2] >> 8);
  t.region = region < kSkinRegionNames.size() ? static_cast<SkinRegion>(region) : SkinRegion::other;
  t.input.has_velocity = (w[2] & 1) != 0;
  t.input.hold = (w[2] & 2) != 0;
  t.in_contact = (w[2] & 4) != 0;
  t.input.dt = real(w[3]);
  for (int k = 0; k < 3; ++k) {
    t.input.position[k] = real(w[4 + k]);
    t.input.velocity[k] = real(w[7 + k]);
    t.force[k] = real(w[10 + k]);
  }
  t.depth = real(w[13]);
  t.map_force = real(w[14]);
  return t;
}

void put_difference(std::string& out, const TickWords& previous, const TickWords& words) {
  std::array<std::uint64_t, kTickWords> changes{};
  std::array<unsigned char, (kTickWords + 1) / 2> counts{};
  for (int i = 0; i < kTickWords; ++i) {
    changes[i] = change(i, previous[i], words[i]);
    const int bytes = (std::bit_width(changes[i]) + 7) / 8;
    counts[i / 2] = static_cast<unsigned char>(counts[i / 2] | (bytes << (4 * (i % 2))));
  }
  out.append(reinterpret_cast<const char*>(counts.data()), counts.size());
  for (int i = 0; i < kTickWords; ++i)
    for (std::uint64_t c = changes[i]; c != 0; c >>= 8) out.push_back(static_cast<char>(c & 0xff));
}

bool get_difference(std::string_view& in, const TickWords& previous, TickWords& words) {
  std::array<unsigned char, (kTickWords + 1) / 2> counts{};
  if (in.size() < counts.size()) return false;
  std::memcpy(counts.data(), in.data(), counts.size());
  in.remove_prefix(counts.size());
  for (int i = 0; i < kTickWords; ++i) {
    const unsigned bytes = (counts[i / 2] >> (4 * (i % 2))) & 15U;
    if (bytes > 8 || in.size() < bytes) return false;
    std::uint64_t c = 0;
    for (unsigned b = 0; b < bytes; ++b)
      c |= static_cast<std::uint64_t>(static_cast<unsigned char>(in[b])) << (8 * b);
    in.remove_prefix(bytes);
    words[i] = apply(i, previous[i], c);
  }
  return true;
}

void put_state(std::string& out, const TickState& state) {
  each_member(state, [&](const auto& member) {
    using T = std::remove_cvref_t<decltype(member)>;
    if constexpr (std::is_same_v<T, double>)
      put(out, bits(member));
    else
      put(out, static_cast<std::uint64_t>(member));
  });
}

bool get_state(std::string_view& in, TickState& state) {
  bool whole = true;
  each_member(state, [&](auto& member) {
    using T = std::remove_reference_t<decltype(member)>;
    std::uint64_t word = 0;
    whole = get(in, word) && whole;
    if constexpr (std::is_same_v<T, double>)
      member = real(word);
    else if constexpr (std::is_same_v<T, bool>)
      member = word != 0;
    else if constexpr (std::is_same_v<T, Feature>)
      member = word <= static_cast<std::uint64_t>(Feature::vertex2) ? static_cast<Feature>(word)
                                                                    : Feature::vertex0;
    else
      member = static_cast<T>(word);
  });
  return whole;
}

std::string encode_header(const RecordingHeader& h) {
  const TickOptions& o = h.options;
  const nlohmann::json json = {{"format", 2},
                               {"model", fmt::format("{:016x}", h.fingerprint)},
                               {"tool_radius_mm", h.tool_radius},
                               {"rate_hz", h.rate_hz},
                               {"device", h.device},
                               {"limits",
                                {{"peak_force_n", h.limits.peak_force},
                                 {"stiffness_n_per_mm", h.limits.stiffness},
                                 {"damping_n_s_per_mm", h.limits.damping},
                                 {"workspace_radius_mm", h.limits.workspace_radius},
                                 {"resolution_mm", h.limits.resolution}}},
                               {"options",
                                {{"keep_ratios", o.scaling == Scaling::ratio},
                                 {"static_friction", o.static_friction},
                                 {"kinetic_friction", o.kinetic_friction},
                                 {"shear_stiffness_n_per_mm", o.shear_stiffness},
                                 {"slip_distance_mm", o.slip_distance},
                                 {"viscous_n_s_per_mm", o.viscous},
                                 {"rate_s_per_mm", o.rate},
                                 {"velocity_cutoff_hz", o.velocity_cutoff},
                                 {"slew_n_per_s", o.slew},
                                 {"soft_start_s", o.soft_start},
                                 {"passivity", o.passivity},
                                 {"passivity_margin_n_mm", o.passivity_margin}}}};
  const std::string text = json.dump();
  std::string out{kMagic};
  put(out, static_cast<std::uint32_t>(text.size()));
  put(out, crc32(text));
  return out + text;
}

std::string encode_block(const RecordedBlock& block) {
  std::string out;
  out.reserve(64 * block.ticks.size() + 512);
  put(out, block.dropped);
  put(out, static_cast<std::uint32_t>(block.ticks.size()));
  put_state(out, block.state);
  TickWords previous{};
  for (const RecordedTick& t : block.ticks) {
    const TickWords words = to_words(t);
    put_difference(out, previous, words);
    previous = words;
  }
  return out;
}

std::optional<RecordedBlock> decode_block(std::string_view payload) {
  RecordedBlock block;
  std::uint32_t count = 0;
  if (!get(payload, block.dropped) || !get(payload, count) || !get_state(payload, block.state))
    return std::nullopt;
  // A tick takes at least the half bytes of its counts.
  if (count > payload.size() / ((kTickWords + 1) / 2)) return std::nullopt;
  block.ticks.reserve(count);
  TickWords previous{};
  for (std::uint32_t i = 0; i < count; ++i) {
    TickWords words{};
    if (!get_difference(payload, previous, words)) return std::nullopt;
    block.ticks.push_back(from_words(words));
    previous = words;
  }
  return payload.empty() ? std::optional(std::move(block)) : std::nullopt;
}

std::string framed(const std::string& payload) {
  std::string out;
  put(out, kBlockMagic);
  put(out, static_cast<std::uint32_t>(payload.size()));
  put(out, crc32(payload));
  return out + payload;
}

}  // namespace palpate::haptics::codec
