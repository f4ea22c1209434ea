// SPDX-License-Identifier: Apache-2.0
// Stands in for the vendor's DHD library in tests. Compiled twice: FAKE_DHD_INCOMPLETE leaves out a
// function, as an old library does.
#include "fake_dhd.hpp"

#include <cstdlib>

static FakeDhd fake;

// For tests that cannot reach `fake`: reads until the device is gone.
static long reads_left() {
  const char* text = std::getenv("FAKE_DHD_LOST_AFTER");
  return text ? std::atol(text) : -1;
}

extern "C" {
FakeDhd* fake_dhd() {
  return &fake;
}
void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
  *major = fake.sdk_major;
  *minor = 17;
  *release = 1;
  *revision = 0;
}
int dhdGetDeviceCount() {
  return fake.devices;
}
int dhdOpenID(char index) {
  if (index >= fake.devices || fake.refuses_open) return -1;
  return index + 3;  // ids are not indices
}
int dhdClose(char id) {
  fake.closed_id = id;
  return 0;
}
int dhdGetPosition(double* x, double* y, double* z, char id) {
  static long left = reads_left();
  if (left == 0) fake.position_result = -1;
  if (left > 0) --left;
  fake.position_id = id;
  *x = fake.position[0];
  *y = fake.position[1];
  *z = fake.position[2];
  return fake.position_result;
}
#ifndef FAKE_DHD_INCOMPLETE
int dhdGetLinearVelocity(double* x, double* y, double* z, char) {
  *x = 0.001;
  *y = 0.002;
  *z = 0.003;
  return 0;
}
#endif
unsigned dhdGetButtonMask(char) {
  return fake.buttons;
}
int dhdSetForce(double x, double y, double z, char) {
  fake.force[0] = x;
  fake.force[1] = y;
  fake.force[2] = z;
  return fake.force_result;
}
int dhdEnableForce(unsigned char on, char) {
  fake.enabled = on;
  return fake.refuses_force ? -1 : 0;
}
double dhdGetMaxForce(char) {
  return fake.max_force;
}
const char* dhdGetSystemName(char) {
  return fake.name;
}
const char* dhdErrorGetLastStr() {
  return "fake error";
}
}
