// SPDX-License-Identifier: Apache-2.0
// Stands in for Haply's local service in tests: same ports' roles, same messages, with faults.
#pragma once
#include <atomic>
#include <memory>
#include <string>

namespace palpate::haptics {

class FakeInverseService {
 public:
  struct Behaviour {
    bool lists_device = true;
    bool applies_force = true;
    bool speaks_json = true;
    int close_after = -1;  ///< messages; -1 never
    int reply_delay_ms = 0;
    bool has_position = true;
    bool lists_second = false;  ///< another one, "1234"
  };
  FakeInverseService() : FakeInverseService(Behaviour{}) {}
  explicit FakeInverseService(const Behaviour& behaviour);
  ~FakeInverseService();

  [[nodiscard]] unsigned short port() const;
  [[nodiscard]] unsigned short event_port() const;
  void trigger_safety_stop();   ///< sends the event to whoever listens
  void unplug();                ///< the device is no longer listed
  void lose_position(bool on);  ///< coordinates become null, as NaN is written

  std::atomic<double> x{0.01}, y{0.02}, z{0.03};           ///< [m] service's axes
  std::atomic<double> force_x{0}, force_y{0}, force_z{0};  ///< [N] last commanded
  std::atomic<bool> button_b{false};                       ///< of the grip
  std::atomic<long> messages{0};
  std::atomic<long> malformed{0};  ///< commands that do not have the documented form

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace palpate::haptics
