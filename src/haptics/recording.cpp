// SPDX-License-Identifier: Apache-2.0
#include "haptics/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <ostream>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "haptics/recording_codec.hpp"

namespace palpate::haptics {

namespace {

RecordingHeader parse_header(const nlohmann::json& json) {
  RecordingHeader h;
  h.limits.name = "the recorded device";
  h.fingerprint = std::stoull(json.at("model").get<std::string>(), nullptr, 16);
  json.at("tool_radius_mm").get_to(h.tool_radius);
  json.at("rate_hz").get_to(h.rate_hz);
  json.at("device").get_to(h.device);
  const auto& limits = json.at("limits");
  limits.at("peak_force_n").get_to(h.limits.peak_force);
  limits.at("stiffness_n_per_mm").get_to(h.limits.stiffness);
  limits.at("damping_n_s_per_mm").get_to(h.limits.damping);
  limits.at("workspace_radius_mm").get_to(h.limits.workspace_radius);
  limits.at("resolution_mm").get_to(h.limits.resolution);
  const auto& o = json.at("options");
  h.options.scaling = o.at("keep_ratios").get<bool>() ? Scaling::ratio : Scaling::none;
  o.at("static_friction").get_to(h.options.static_friction);
  o.at("kinetic_friction").get_to(h.options.kinetic_friction);
  o.at("shear_stiffness_n_per_mm").get_to(h.options.shear_stiffness);
  o.at("slip_distance_mm").get_to(h.options.slip_distance);
  o.at("viscous_n_s_per_mm").get_to(h.options.viscous);
  o.at("rate_s_per_mm").get_to(h.options.rate);
  o.at("velocity_cutoff_hz").get_to(h.options.velocity_cutoff);
  o.at("slew_n_per_s").get_to(h.options.slew);
  o.at("soft_start_s").get_to(h.options.soft_start);
  o.at("passivity").get_to(h.options.passivity);
  o.at("passivity_margin_n_mm").get_to(h.options.passivity_margin);
  return h;
}

std::string_view take_header(std::string_view in, const std::string& name,
                             RecordingHeader& header) {
  const auto refuse = [&](const std::string& why) {
    return InputError(fmt::format("{}: {}; record again", name, why));
  };
  if (in.substr(0, codec::kMagic.size()) != codec::kMagic) {
    if (in.substr(0, codec::kMagic.size() - 1) == codec::kMagic.substr(0, codec::kMagic.size() - 1))
      throw InputError(name + ": a recording of another version; use the program that wrote it");
    throw InputError(name + ": not a recording of touch; give a file written with --record");
  }
  in.remove_prefix(codec::kMagic.size());
  std::uint32_t size = 0, crc = 0;
  if (!codec::get(in, size) || !codec::get(in, crc) || in.size() < size)
    throw refuse("the header is cut off");
  const std::string_view text = in.substr(0, size);
  if (codec::crc32(text) != crc) throw refuse("the header is damaged");
  try {
    header = parse_header(nlohmann::json::parse(text));
  } catch (const std::exception& e) {
    throw refuse(fmt::format("the header cannot be read ({})", e.what()));
  }
  return in.substr(size);
}

}  // namespace

std::size_t Recording::tick_count() const {
  std::size_t n = 0;
  for (const RecordedBlock& b : blocks) n += b.ticks.size();
  return n;
}

Recording parse_recording(std::string_view bytes, const std::string& name) {
  Recording recording;
  std::string_view in = take_header(bytes, name, recording.header);
  while (!in.empty()) {
    const std::size_t at = bytes.size() - in.size();
    std::uint32_t magic = 0, size = 0, crc = 0;
    const bool head = codec::get(in, magic) && codec::get(in, size) && codec::get(in, crc);
    const char* why = !head || in.size() < size ? "cut off" : "damaged";
    std::optional<RecordedBlock> block;
    if (head && magic == codec::kBlockMagic && in.size() >= size &&
        codec::crc32(in.substr(0, size)) == crc)
      block = codec::decode_block(in.substr(0, size));
    if (!block) {
      recording.ending = fmt::format("{}: {} at byte {}; the {} ticks before it are used", name,
                                     why, at, recording.tick_count());
      break;
    }
    recording.blocks.push_back(std::move(*block));
    in.remove_prefix(size);
  }
  return recording;
}

Recording read_recording(const std::filesystem::path& path) {
  return parse_recording(read_file(path), path.string());
}

ReplayResult replay(const Recording& recording, const TouchModel& model) {
  if (model.fingerprint != recording.header.fingerprint)
    throw InputError(
        fmt::format("the recording was made on another head, or with another tool radius than {} "
                    "mm; give the head that was touched",
                    model.tool_radius));
  const TickSetup setup = make_tick_setup(model, recording.header.limits, recording.header.options);
  ReplayResult result;
  for (const RecordedBlock& block : recording.blocks) {
    if (block.dropped > 0) ++result.gaps;
    TickState state = block.state;
    // A state from a file may name any triangle.
    const SurfacePoint& anchor = state.proxy.anchor;
    if (anchor.triangle >= static_cast<std::int32_t>(model.mesh.triangles.size()) ||
        (state.proxy.touching && !anchor.found()))
      throw InputError("the recording names a triangle that this head does not have");
    const auto unknown = [&](std::int32_t corner) {
      return corner < 0 || corner >= static_cast<std::int32_t>(model.mesh.points.size());
    };
    const Triangle& corners = state.settled.corners;
    if (state.in_contact && std::any_of(corners.begin(), corners.end(), unknown))
      throw InputError("the recording names a point that this head does not have");
    for (const RecordedTick& t : block.ticks) {
      const double before = state.removed;
      const TickOutput out = tick(setup, t.input, state);
      if (out.damped > 0) ++result.damped;
      result.removed += state.removed - before;
      if (std::memcmp(out.force.data(), t.force.data(), 3 * sizeof(double)) != 0) {
        if (result.different++ == 0) result.first_different = result.ticks;
        result.largest_difference =
            std::max(result.largest_difference, (out.force - t.force).norm());
      }
      ++result.ticks;
    }
  }
  return result;
}

void write_csv(const Recording& recording, std::ostream& out) {
  out << "time_s,x_mm,y_mm,z_mm,vx_mm_s,vy_mm_s,vz_mm_s,fx_n,fy_n,fz_n,depth_mm,map_force_n,"
         "in_contact,region,held,trip,buttons,late_us\n";
  std::int64_t start = 0;
  bool first = true;
  for (const RecordedBlock& block : recording.blocks)
    for (const RecordedTick& t : block.ticks) {
      if (first) start = t.time_ns;
      first = false;
      const Vec3& p = t.input.position;
      const Vec3& v = t.input.velocity;
      out << fmt::format("{:.6f},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{:.1f}\n",
                         1e-9 * static_cast<double>(t.time_ns - start), p.x(), p.y(), p.z(), v.x(),
                         v.y(), v.z(), t.force.x(), t.force.y(), t.force.z(), t.depth, t.map_force,
                         t.in_contact ? 1 : 0, name(t.region), t.input.hold ? 1 : 0, t.trip,
                         t.buttons, 1e-3 * static_cast<double>(t.late_ns));
    }
}

}  // namespace palpate::haptics
