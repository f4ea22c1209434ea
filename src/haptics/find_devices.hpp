// SPDX-License-Identifier: Apache-2.0
// Which haptic devices are here, and what is missing for those that are not.
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "haptics/device.hpp"

namespace palpate::haptics {

/// Where to look. The defaults are what the vendors install.
struct FindOptions {
  std::vector<std::string> dhd_libraries = {"libdhd.so.3", "libdhd.so", "libdrd.so.3", "libdrd.so"};
  std::vector<std::string> hd_libraries = {"libHD.so", "libHD.so.3", "libHD.so.3.4"};
  std::string inverse_host = "127.0.0.1";
  unsigned short inverse_port = 10001;        ///< simulation channel of the Haply service
  unsigned short inverse_event_port = 10020;  ///< its events
  double timeout = 1.0;                       ///< [s] for the service to answer
};

/// One line of `palpate devices`.
struct DeviceFinding {
  std::string backend;  ///< name to open it by; with ":n" where there are several
  std::string name;     ///< model, or the backend's devices in words
  bool usable = false;
  std::string detail;  ///< serial and limits, or exactly what is missing and what to do
};

/// Every backend in turn: simulated, force-dimension, inverse3, touch. Opens devices briefly, with
/// force off. Throws nothing; a backend that fails is a line.
[[nodiscard]] std::vector<DeviceFinding> list_devices(const FindOptions& options = {});

/// Opens by backend ("force-dimension", "force-dimension:1", "inverse3:049D", "touch:Left"), or the
/// first usable device for "auto".
/// @throws InputError  nothing such is there; the message says what is missing
[[nodiscard]] std::unique_ptr<Device> open_device(std::string_view backend,
                                                  const FindOptions& options = {});

// The backends, for open_device() and the tests. Each throws InputError with the reason.
/// @param index  as the SDK counts devices, from 0
[[nodiscard]] std::unique_ptr<Device> open_force_dimension(int index, const FindOptions& options);
/// @param configuration  name given in the vendor's set-up program; empty for its default device
[[nodiscard]] std::unique_ptr<Device> open_touch(const std::string& configuration,
                                                 const FindOptions& options);
/// @param device_id  as the service reports it; empty for the first
[[nodiscard]] std::unique_ptr<Device> open_inverse3(const std::string& device_id,
                                                    const FindOptions& options);
[[nodiscard]] std::vector<DeviceFinding> find_force_dimension(const FindOptions& options);
[[nodiscard]] std::vector<DeviceFinding> find_touch(const FindOptions& options);
[[nodiscard]] std::vector<DeviceFinding> find_inverse3(const FindOptions& options);

/// "8.0 N, 3.0 N/mm" for a finding's detail.
[[nodiscard]] std::string describe(const DeviceInfo& info);

}  // namespace palpate::haptics
