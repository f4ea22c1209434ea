// SPDX-License-Identifier: GPL-3.0-or-later
// A head in closed form with a pointer, a loop and a server around it.
#pragma once
#include "haptics/scenes.hpp"
#include "serve/server.hpp"

namespace palpate::serve {

struct Scene {
  haptics::TouchModel model = haptics::make_touch_model(haptics::scenes::bumpy_head(24));
  haptics::TickSetup setup = haptics::make_tick_setup(model, haptics::unlimited());
  PointerDevice pointer;
  haptics::TouchCycle cycle{setup, pointer, {}};
  haptics::TouchLoop loop{cycle, {.priority = 0}};
  LiveTouch live{cycle, loop, &pointer, nullptr, {"head.glb", {}, ""}};
};

}  // namespace palpate::serve
