// SPDX-License-Identifier: MIT
// A state folder with passed checks of the devices of the tests: with them, a client without a
// terminal uses a device. The text is the format of the file that users have.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace hapticast::testing {

/// $XDG_STATE_HOME of the programs of a test.
class StateFolder {
 public:
  explicit StateFolder(const std::filesystem::path& folder) : checks_(folder / "hapticast") {
    ::setenv("XDG_STATE_HOME", folder.c_str(), 1);
    std::filesystem::create_directories(checks_);
    checks_ /= "checked-devices";
    std::ofstream(checks_) << "d-standin-S1 = 0.045 0.055: 0.045 1\n"
                              "d-example = 0.05 0.05: 0.05 1\n"
                              "d-falcon-FT0TEST1 = 0.1 0.038: 0.1 1\n"
                              "d-inverse3-D1 = 0.03 0.1: 0.03 2\n"
                              "d-dhd-4711 = 0.03 0.01: 0.03 1\n"
                              "d-dhd-4712 = 0.03 0.02: 0.03 1\n"
                              "d-touch-D1 = 0.045 0.055: 0.045 1\n"
                              "d-touch-D2 = 0.045 0.055: 0.045 1\n";
  }
  ~StateFolder() { ::unsetenv("XDG_STATE_HOME"); }
  StateFolder(const StateFolder&) = delete;
  StateFolder& operator=(const StateFolder&) = delete;

  /// No device counts as checked any more.
  void forgetChecks() const { std::filesystem::remove(checks_); }

 private:
  std::filesystem::path checks_;
};

}  // namespace hapticast::testing
