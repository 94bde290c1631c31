// SPDX-License-Identifier: MIT
#include "client/desk/first_check.hpp"

#include <fmt/core.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <future>

#include "client/device/device_request.hpp"
#include "client/device/loop/realtime_thread.hpp"
#include "common/private_file.hpp"

namespace hapticast::client {

namespace {

std::string checkFile() { return (stateFolder() / "checked-devices").string(); }

/// Returns the name of the device for `hapticast-client check`.
std::string nameDevice(const HapticDevice& device) {
  const std::string id = device.id();
  return id.substr(0, id.find(' '));
}

/// Returns true if a user can type at the standard input. A program in the background must not
/// read the terminal: the system stops it.
bool hasTerminal() { return isatty(STDIN_FILENO) != 0 && tcgetpgrp(STDIN_FILENO) == getpgrp(); }

/// Returns true if the user has pressed Enter in the terminal.
bool pressedEnter() {
  if (!hasTerminal()) return false;
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  char byte = '\0';
  while (::poll(&input, 1, 0) > 0 && ::read(STDIN_FILENO, &byte, 1) == 1) {
    if (byte == '\n') return true;
  }
  return false;
}

void logLine(const std::string& line) { spdlog::info("{}", line); }

/// Shows a request in the views until the end of the object.
class Request {
 public:
  Request(UserInterface& ui, const std::string& text) : ui_(ui) {
    ui_.setRequest(text);
    spdlog::warn("{}", text);
  }
  ~Request() { ui_.setRequest(""); }
  Request(const Request&) = delete;
  Request& operator=(const Request&) = delete;

 private:
  UserInterface& ui_;
};

/// Waits until the user confirms. Returns false if `stop` became true.
bool waitForEnter(HapticDevice& device, const std::atomic<bool>& stop, UserInterface& ui,
                  const std::function<void()>& turn) {
  const Request request(
      ui, fmt::format("the client checks {} before its first force: let go of the grip, then press "
                      "Enter; the check pushes the grip with 0.3 N for 2 s",
                      device.id()));
  if (hasTerminal()) (void)tcflush(STDIN_FILENO, TCIFLUSH);  // Enter from before confirms nothing
  while (!stop && !ui.confirmed() && !pressedEnter()) {
    while (const auto line = device.nextMessage()) logLine(*line);
    turn();
  }
  return !stop;
}

}  // namespace

bool applyStoredCheck(const HapticDevice& device, DeviceProfile& profile) {
  if (device.id().empty()) return true;
  const auto check = readCheck(checkFile(), device.id(), profile);
  if (!check) return false;
  applyCheck(*check, profile);
  return true;
}

void storeResult(const HapticDevice& device, const DeviceCheck& check) {
  if (!device.id().empty()) storeCheck(checkFile(), device.id(), device.profile(), check);
  if (!check.fault.empty()) return;
  spdlog::info(
      "check: the device follows in sign and axis; it moves like {:.0f} g, {} ms pass from a "
      "position to its force, and its position moves in steps of {:.3f} mm",
      1e3 * check.mass_kg, check.delay_ticks, check.count_mm);
  if (!check.note.empty()) spdlog::warn("check: {}", check.note);
}

void requireConfirmation(const HapticDevice& device, const UserInterface& ui) {
  if (ui.hasWindow() || hasTerminal()) return;
  throw DeviceAbsent(
      fmt::format("the device {} has passed no check: run hapticast-client check {} first, "
                  "or start the client in a terminal or with a window",
                  device.id(), nameDevice(device)));
}

bool runFirstCheck(HapticDevice& device, const Clock& clock, const std::atomic<bool>& stop,
                   UserInterface& ui, const std::function<void()>& turn) {
  if (!waitForEnter(device, stop, ui, turn)) return false;
  const Request request(ui, "the client checks the device: do not touch its grip");
  auto result = std::async(std::launch::async, [&] {
    (void)requestRealtime();
    return checkDevice(device, clock, stop, logLine);
  });
  while (result.wait_for(std::chrono::seconds(0)) != std::future_status::ready) turn();
  const auto check = result.get();
  if (!check) return false;
  storeResult(device, *check);
  if (!check->fault.empty())
    throw DeviceAbsent(
        fmt::format("the client refuses the device {}: {}", device.id(), check->fault));
  return true;
}

}  // namespace hapticast::client
