// SPDX-License-Identifier: MIT
#include "client/device/helper/program/helper_program.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <exception>
#include <map>
#include <string>
#include <thread>

#include "client/device/helper/driver_files.hpp"
#include "client/device/helper/driver_profile.hpp"
#include "client/device/helper/messages.hpp"
#include "client/device/helper/program/helper_loop.hpp"
#include "client/device/helper/program/network_filter.hpp"
#include "client/device/helper/shared_page.hpp"
#include "client/device/loop/realtime_thread.hpp"

namespace hapticast::client {

namespace {

using std::chrono::milliseconds;
using Kind = HelperMessage::Kind;

constexpr Duration kWatch = milliseconds(5);
constexpr Duration kHungForGood = std::chrono::seconds(1);
constexpr int kHungExit = 3;
constexpr std::size_t kWhy_bytes = 256;
constexpr int kMostFound = 32;
// A driver's own thread runs above the helper's loop, and that loop above the client's.
constexpr int kAboveClientLoop = 1;
constexpr int kAboveHelperLoop = 2;

void send(Kind kind, const std::string& text, const std::string& problem = {}) {
  (void)sendMessage(kHelperSocket, {.kind = kind, .text = text, .problem = problem});
}

void logLine(void* /*self*/, const char* line) {
  if (line != nullptr) send(Kind::kLog, line);
}

const char* findOption(void* self, const char* key) {
  const auto& options = *static_cast<const std::map<std::string, std::string>*>(self);
  const auto found = key == nullptr ? options.end() : options.find(key);
  return found == options.end() ? nullptr : found->second.c_str();
}

/// Text of a driver, which may lack its end.
std::string toString(const std::array<char, kWhy_bytes>& text) {
  return {text.begin(), std::find(text.begin(), text.end(), '\0')};
}

/// The socket ends with the client. While a device opens, nothing has to be ended.
bool clientEnded() {
  std::array<char, 1> byte{};
  const auto size = recv(kHelperSocket, byte.data(), byte.size(), MSG_DONTWAIT | MSG_PEEK);
  return size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR);
}

/// Watches the client and the loop. Ends the process if the driver hangs for good.
class Watch {
 public:
  Watch() : thread_([this] { run(); }) {}
  ~Watch() {
    stop_ = true;
    thread_.join();
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  /// From now on the thread watches `loop`, too.
  void setLoop(HelperLoop* loop) { loop_.store(loop, std::memory_order_release); }

 private:
  void run() {
    Duration ending{};
    while (!stop_) {
      std::this_thread::sleep_for(kWatch);
      HelperLoop* const loop = loop_.load(std::memory_order_acquire);
      const bool ended = clientEnded();
      if (loop == nullptr) {
        if (ended) _exit(0);
        continue;
      }
      if (ended) loop->end();
      ending = ended ? ending + kWatch : Duration{};
      const Duration hangs = loop->monitor();
      if (hangs < kHungForGood && ending < kHungForGood) continue;
      if (!ended) send(Kind::kLog, "its driver does not return from a call; the helper ends it");
      _exit(kHungExit);
    }
  }

  std::atomic<HelperLoop*> loop_{nullptr};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

int listDevices(const hapticast_driver& driver, const hapticast_host& host) {
  int found = 0;
  const auto add = [](void* to, const char* id, const char* problem) {
    if (++*static_cast<int*>(to) > kMostFound) return;
    send(Kind::kFound, id == nullptr ? "" : id, problem == nullptr ? "" : problem);
  };
  std::array<char, kWhy_bytes> why{};
  if (driver.list(&host, add, &found, why.data()) != HAPTICAST_OK) {
    send(Kind::kRefused, toString(why));
    return 1;
  }
  send(Kind::kListed, "");
  return 0;
}

int runDevice(const hapticast_driver& driver, const hapticast_host& host) {
  Watch watch;
  hapticast_profile profile = unknownProfile();
  std::array<char, kWhy_bytes> why{};
  hapticast_device* const device =
      driver.open(&host, host.option(host.self, "serial"), &profile, why.data());
  if (device == nullptr) {
    const std::string reason = toString(why);
    send(reason.starts_with("--") ? Kind::kRefused : Kind::kAbsent, reason);
    return 1;
  }
  (void)driver.zero(device);
  const SteadyClock clock;
  const PageMapping mapping(kHelperPage);
  HelperLoop loop(driver, device, mapping.page(), clock);
  (void)sendMessage(kHelperSocket, {.kind = Kind::kOpened, .profile = profile});
  watch.setLoop(&loop);
  std::thread thread([&loop] {
    (void)requestRealtime(kAboveClientLoop);
    loop.run();
  });
  thread.join();
  if (driver.zero(device) != 0)
    send(Kind::kLog, "the device does not confirm zero force: switch its power off");
  driver.close(device);
  watch.setLoop(nullptr);
  return 0;
}

const hapticast_driver* findDriver(const std::string& name) {
  if (const hapticast_driver* const driver = findBuiltInDriver(name)) return driver;
  if (const hapticast_driver* const driver = loadDriverFile(name, driverFolders())) return driver;
  throw std::runtime_error("there is no driver of this name");
}

}  // namespace

int runHelper(const HelperTask& task) {
  // The client ends the helper by the socket, so that the force ends first.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) std::signal(signal, SIG_IGN);
  (void)requestRealtime(kAboveHelperLoop);  // threads of the driver inherit it
  try {
    const hapticast_driver* const driver = findDriver(task.driver);
    if ((driver->flags & HAPTICAST_NEEDS_NETWORK) == 0) (void)refuseNetwork();
    auto options = task.options;
    const hapticast_host host{sizeof host, &options, logLine, findOption};
    return task.list ? listDevices(*driver, host) : runDevice(*driver, host);
  } catch (const std::exception& error) {
    send(Kind::kRefused, error.what());
    return 1;
  }
}

}  // namespace hapticast::client
