// SPDX-License-Identifier: Apache-2.0
#include "fake_hd.hpp"

#include <chrono>
#include <thread>

static FakeHd fake;
static unsigned (*callback)(void*) = nullptr;
static void* callback_data = nullptr;
static std::thread scheduler;

extern "C" {
FakeHd* fake_hd() {
  return &fake;
}
struct ErrorInfo {
  unsigned code;
  int internal;
  unsigned handle;
};
unsigned hdInitDevice(const char*) {
  return fake.present ? 7 : 0xffffffffU;
}
void hdDisableDevice(unsigned) {}
void hdMakeCurrentDevice(unsigned) {}
void hdBeginFrame(unsigned) {
  ++fake.frames;
}
void hdEndFrame(unsigned) {}
void hdGetDoublev(unsigned what, double* out) {
  if (what == 0x2050) {
    out[0] = fake.x;
    out[1] = fake.y;
    out[2] = fake.z;
  } else if (what == 0x2051) {
    out[0] = out[1] = out[2] = 5;
  } else if (what == 0x2603) {
    *out = fake.max_force;
  }
}
void hdGetIntegerv(unsigned, int* out) {
  *out = fake.buttons;
}
const char* hdGetString(unsigned what) {
  return what == 0x2501 ? "Touch" : "SN1";
}
void hdSetDoublev(unsigned what, const double* v) {
  if (what != 0x2700) return;
  fake.force_x = v[0];
  fake.force_y = v[1];
  fake.force_z = v[2];
}
void hdEnable(unsigned) {}
ErrorInfo hdGetError() {
  return {fake.present ? fake.error.load() : 0x0301U, 0, 7};
}
const char* hdGetErrorString(unsigned) {
  return "fake error";
}
unsigned long hdScheduleAsynchronous(unsigned (*f)(void*), void* data, unsigned short) {
  callback = f;
  callback_data = data;
  return 1;
}
void hdUnschedule(unsigned long) {
  callback = nullptr;
}
void hdStartScheduler() {
  fake.running = true;
  scheduler = std::thread([] {
    while (fake.running) {
      if (callback && !fake.stalled) callback(callback_data);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
}
void hdStopScheduler() {
  fake.running = false;
  if (scheduler.joinable()) scheduler.join();
}
}
