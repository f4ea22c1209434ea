// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/study_session.hpp"

#include <fmt/format.h>

#include <cstring>

#include "apps/study_touch.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/head_file.hpp"
#include "serve/access.hpp"

namespace palpate::app {
namespace fs = std::filesystem;
using study::Store;
using study::Study;

namespace {

template <class T>
void append(std::string& out, const T& value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

/// Two counts, points as 32-bit floats [mm, head frame], triangles: little-endian. A participant's
/// page gets this instead of head.glb, which carries regions and stiffness.
std::string skin_bytes(const haptics::ContactMesh& mesh) {
  std::string out;
  append(out, static_cast<std::uint32_t>(mesh.points.size()));
  append(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Vec3& p : mesh.points)
    for (int k = 0; k < 3; ++k) append(out, static_cast<float>(p[k]));
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t corner : t) append(out, static_cast<std::uint32_t>(corner));
  return out;
}

std::uint64_t drawn_seed() {
  return std::stoull(serve::new_token().substr(0, 15), nullptr, 16);
}

Study make_study(const StudyOptions& o, const study::Protocol& protocol,
                 const haptics::TouchModel& model) {
  Study s;
  s.id = serve::new_token();
  s.title = protocol.title;
  s.protocol_name = protocol.name;
  s.protocol_text = protocol.text;
  s.head_name = o.head.filename().string();
  s.head_fingerprint = fmt::format("{:016x}", model.fingerprint);
  s.tool_radius = model.tool_radius;
  s.seed = o.seed ? o.seed : drawn_seed();
  s.program = fmt::format("palpate {}", kVersion);
  s.created = study::now();
  s.planned_participants = o.participants ? o.participants : protocol.participants;
  if (o.simulate) s.simulation = study::simulation_json(o.simulation);
  s.regions = study_regions(model, protocol.regions);
  return s;
}

void check_same(const StudyOptions& o, const Study& s, const study::Protocol& protocol,
                const haptics::TouchModel& model) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("{}: {}; give another --output", o.output.string(), why));
  };
  if (s.protocol_text != protocol.text)
    refuse(fmt::format("the study goes by another text of the protocol {}", s.protocol_name));
  if (s.head_fingerprint != fmt::format("{:016x}", model.fingerprint))
    refuse(fmt::format("the study is of another head, {}", s.head_name));
  if (o.seed && o.seed != s.seed) refuse(fmt::format("the study's seed is {}", s.seed));
  if (o.simulate == s.simulation.empty())
    refuse(o.simulate ? "the study's participants are people" : "the study is a simulated one");
  if (o.simulate && s.simulation != study::simulation_json(o.simulation))
    refuse("the study was simulated with other settings, " + s.simulation);
}

}  // namespace

OpenStudy open_study(const StudyOptions& o) {
  study::Protocol protocol = study::read_protocol(o.protocol);
  haptics::TouchModel model = haptics::make_touch_model(io::read_head(o.head));
  // A simulated study survives a kill; only people's answers are worth a disk's patience.
  const auto durability = o.simulate ? Store::Durability::process : Store::Durability::full;
  const bool exists = fs::exists(o.output);
  // Looked at before it is opened to write: what is refused stays as it was.
  if (exists) check_same(o, Store::open(o.output, Store::Access::read).study(), protocol, model);
  Store store = exists ? Store::open(o.output, Store::Access::run, durability)
                       : Store::create(o.output, make_study(o, protocol, model), durability);
  Study s = store.study();
  std::string skin = skin_bytes(model.mesh);
  return {std::move(protocol), std::move(model), std::move(s), std::move(store), std::move(skin)};
}

}  // namespace palpate::app
