// SPDX-License-Identifier: Apache-2.0
// What a test can set on, and read from, the stand-in for DHD. SDK's axes and units.
#pragma once

struct FakeDhd {
  int sdk_major = 3;
  int devices = 1;
  bool refuses_open = false;
  bool refuses_force = false;
  double position[3] = {0.01, 0.02, 0.03};
  int position_result = 0;
  int force_result = 0;
  unsigned buttons = 0;
  double max_force = -1;
  const char* name = "Novint Falcon";
  double force[3] = {};
  int enabled = 0;
  int position_id = -1;
  int closed_id = -1;
};
