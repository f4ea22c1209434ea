// SPDX-License-Identifier: Apache-2.0
// One step of touch: tool position in, force out (docs/method/touch.md).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "haptics/contact.hpp"
#include "haptics/device_limits.hpp"
#include "haptics/touch_model.hpp"

namespace palpate::haptics {

struct TickOptions {
  Scaling scaling = Scaling::ratio;  ///< how a device weaker than the tissue is served
  /// [-] Coulomb friction of a fingertip on dry skin; 0 <= kinetic <= static <= 2. Both 0: none.
  double static_friction = 0.35;
  double kinetic_friction = 0.30;
  double shear_stiffness = 0.5;  ///< [N/mm] of the sticking contact; clipped to the device's
  double slip_distance = 1.0;    ///< [mm] over which static friction falls to kinetic; > 0
  double viscous = 0.0005;       ///< [N s/mm] damping in contact; clipped to the device's
  /// [s/mm] Hunt-Crossley: force times (1 + rate * speed of indenting). 0.002 is a loss tangent of
  /// 0.1 at 1 Hz and 8 mm. 0 turns it off.
  double rate = 0.002;
  double velocity_cutoff = 80;  ///< [Hz] low pass on the tool's velocity; > 0
  double slew = 500;            ///< [N/s] fastest change of the force; > 0
  double soft_start = 0.3;      ///< [s] ramp when a contact begins inside the head; >= 0
  bool passivity = true;        ///< time-domain passivity controller
  /// [N mm] Dissipated energy that the controller remembers beyond what is stored in the tissue.
  /// Smaller reacts sooner to generated energy, larger disturbs less.
  double passivity_margin = 20;
};

/// All that stays the same from tick to tick. Makes no reference to a device.
struct TickSetup {
  const TouchModel* model = nullptr;  ///< outlives the set-up
  TickOptions options;
  DeviceLimits limits;
  double scale = 1;       ///< [-] device force over mapped force
  bool reshaped = false;  ///< some curve is steeper than the device can render
  CurveTable curves;      ///< limited curves; empty where !reshaped
  std::vector<std::string> warnings;
};
/// @throws InputError  an option out of range, named
[[nodiscard]] TickSetup make_tick_setup(const TouchModel& model, const DeviceLimits& limits,
                                        const TickOptions& options = {});

struct TickInput {
  Vec3 position = Vec3::Zero();  ///< [mm] of the tool's centre, head frame
  Vec3 velocity = Vec3::Zero();  ///< [mm/s] as the device reports it
  double dt = 0.001;             ///< [s] since the last tick; clipped to 0.0001 ... 0.01
  bool has_velocity = false;     ///< false: estimated from the positions
  bool hold = false;             ///< clutch: no force, and what comes after is a fresh start
};

/// What the hand felt last, so that the next tick can go over from it.
struct Settled {
  Vec3 normal = Vec3::Zero();    ///< [-] unit
  double force = 0;              ///< [N] elastic push
  double depth = 0;              ///< [mm]
  double stiffness = 0;          ///< [N/mm]
  Triangle corners{-1, -1, -1};  ///< of the touched triangle, points of the mesh
  Vec3 weights = Vec3::Zero();   ///< [-]
};

/// The tick's whole memory. Plain data without pointers: a copy continues the same touch,
/// bit for bit.
struct TickState {
  ProxyState proxy;
  Vec3 position = Vec3::Zero();  ///< [mm] last tick, as reported
  Vec3 mean = Vec3::Zero();      ///< [mm] of the reported positions, over a tenth of a second
  Vec3 tool = Vec3::Zero();      ///< [mm] last tick, as felt: steps of the encoders smoothed
  Vec3 velocity = Vec3::Zero();  ///< [mm/s] filtered
  Vec3 force = Vec3::Zero();     ///< [N] put out last
  Vec3 asked = Vec3::Zero();     ///< [N] the same before the passivity controller
  Settled settled;               ///< meaningful while in_contact
  Vec3 shear = Vec3::Zero();     ///< [mm] tool minus friction anchor, tangential
  double slip = 0;               ///< [-] 0 sticking, 1 slipping in full
  double ramp = 1;               ///< [-] soft start
  double balance = 0;            ///< [N mm] energy taken from the hand less given back
  double generated = 0;          ///< [N mm] given back more than taken, since the start; <= 0
  double removed = 0;            ///< [N mm] taken out by the passivity controller since the start
  std::uint64_t ticks = 0;
  bool started = false;
  bool in_contact = false;
};

struct TickOutput {
  Vec3 force = Vec3::Zero();    ///< [N] for the device, head frame
  Vec3 normal = Vec3::Zero();   ///< [-] direction of the elastic push, settled
  Vec3 point = Vec3::Zero();    ///< [mm] touched point of the skin, head frame
  double depth = 0;             ///< [mm]
  double map_force = 0;         ///< [N] the blended curve of the map at `depth`
  double stiffness = 0;         ///< [N/mm] slope of the blended map there
  double elastic = 0;           ///< [N] the same as the device renders it: scaled, limited, settled
  double damped = 0;            ///< [N] change of the force by the passivity controller
  Vec3 weights = Vec3::Zero();  ///< [-] of the touched triangle's corners
  std::array<std::int32_t, 3> vertices{-1, -1, -1};  ///< corners, as numbered in the scan
  SkinRegion region = SkinRegion::other;
  bool in_contact = false;
  bool estimated = false;  ///< a corner's curve was carried over, not computed
  bool settling = false;   ///< going over to another flank: `elastic` and `normal` lag behind
  bool clamped = false;    ///< the device's force limit acted
  bool slewed = false;     ///< the slew limit acted
  bool finite = true;      ///< false: the input was not finite; force 0 and a fresh start
};

/// One tick: contact, blended curves, rate and friction, limits, passivity.
/// @note Allocates nothing, takes no lock, throws nothing, no I/O; same bits for the same input and
///       state on every x86-64 machine. About 1 us.
[[nodiscard]] TickOutput tick(const TickSetup& setup, const TickInput& input,
                              TickState& state) noexcept;

}  // namespace palpate::haptics
