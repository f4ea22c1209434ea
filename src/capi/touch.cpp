// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <optional>

#include "capi/handles.hpp"

using namespace palpate;
using namespace palpate::haptics;
using capi::guarded;
using capi::put;
using capi::report;

namespace {

palpate_touch_options options_for(const DeviceLimits& limits) {
  const TickOptions o;
  palpate_touch_options out{};
  out.size = sizeof(out);
  out.ratio = o.scaling == Scaling::ratio;
  out.passivity = o.passivity;
  out.peak_force = limits.peak_force;
  out.stiffness = limits.stiffness;
  out.damping = limits.damping;
  out.static_friction = o.static_friction;
  out.kinetic_friction = o.kinetic_friction;
  out.viscous = o.viscous;
  out.rate = o.rate;
  out.slew = o.slew;
  out.soft_start = o.soft_start;
  out.resolution = limits.resolution;
  return out;
}

TickSetup setup_for(const TouchModel& model, const palpate_touch_options& in) {
  TickOptions o;
  o.scaling = in.ratio ? Scaling::ratio : Scaling::none;
  o.passivity = in.passivity != 0;
  o.static_friction = in.static_friction;
  o.kinetic_friction = in.kinetic_friction;
  o.viscous = in.viscous;
  o.rate = in.rate;
  o.slew = in.slew;
  o.soft_start = in.soft_start;
  return make_tick_setup(
      model, {"the device", in.peak_force, in.stiffness, in.damping, 0, in.resolution}, o);
}

void put_output(const TickOutput& out, palpate_tick_output* to) {
  put(out.force, to->force);
  put(out.normal, to->normal);
  put(out.point, to->point);
  to->depth = out.depth;
  to->map_force = out.map_force;
  to->stiffness = out.stiffness;
  to->elastic = out.elastic;
  to->damped = out.damped;
  put(out.weights, to->weight);
  for (std::size_t k = 0; k < 3; ++k) to->vertex[k] = out.vertices[k];
  to->region = static_cast<int32_t>(out.region);
  to->in_contact = out.in_contact;
  to->estimated = out.estimated;
  to->limited = (out.clamped ? 1 : 0) | (out.slewed ? 2 : 0);
  to->finite = out.finite;
}

}  // namespace

extern "C" {

palpate_status palpate_touch_defaults(const char* device, palpate_touch_options* options) {
  if (!options) return PALPATE_BAD_ARGUMENT;
  if (!device) {
    *options = options_for(unlimited());
    return PALPATE_OK;
  }
  std::optional<DeviceLimits> limits;
  const palpate_status status = guarded(nullptr, [&] {
    limits = std::strcmp(device, "published") == 0 ? published_preset() : limits_of(device);
  });
  if (status != PALPATE_OK) return status;
  if (!limits) return PALPATE_BAD_ARGUMENT;
  *options = options_for(*limits);
  return PALPATE_OK;
}

palpate_status palpate_touch_new(const palpate_head* head, const palpate_touch_options* options,
                                 palpate_touch** touch, palpate_error* error) {
  if (touch) *touch = nullptr;
  if (!head || !touch) return report(PALPATE_BAD_ARGUMENT, "head or touch is null", error);
  const palpate_touch_options chosen = options ? *options : options_for(unlimited());
  if (chosen.size != sizeof(chosen))
    return report(PALPATE_BAD_ARGUMENT,
                  "the options' size does not fit: call palpate_touch_defaults() first", error);
  const palpate_status status = guarded(error, [&] {
    auto made = std::make_unique<palpate_touch>();
    made->model = head->model;
    made->setup = setup_for(*head->model, chosen);
    *touch = made.release();
  });
  if (status != PALPATE_BAD_INPUT) return status;
  if (error) error->status = PALPATE_BAD_ARGUMENT;  // an option out of range
  return PALPATE_BAD_ARGUMENT;
}

void palpate_touch_free(palpate_touch* touch) {
  delete touch;
}

double palpate_touch_scale(const palpate_touch* touch) {
  return touch ? touch->setup.scale : 0;
}

const char* palpate_touch_warning(const palpate_touch* touch, uint32_t index) {
  return touch && index < touch->setup.warnings.size() ? touch->setup.warnings[index].c_str()
                                                       : nullptr;
}

palpate_status palpate_touch_tick(palpate_touch* touch, const palpate_tick_input* input,
                                  palpate_tick_output* output) {
  if (!touch || !input || !output) return PALPATE_BAD_ARGUMENT;
  TickInput in;
  in.position = capi::vector(input->position);
  in.velocity = capi::vector(input->velocity);
  in.dt = input->dt;
  in.has_velocity = input->has_velocity != 0;
  in.hold = input->hold != 0;
  put_output(tick(touch->setup, in, touch->state), output);
  return PALPATE_OK;
}

void palpate_touch_reset(palpate_touch* touch) {
  if (touch) touch->state = {};
}

double palpate_touch_removed(const palpate_touch* touch) {
  return touch ? touch->state.removed : 0;
}

}  // extern "C"
