// SPDX-License-Identifier: MIT
// A real nats-server on a free port of this machine. Thread: one.
#pragma once

#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/installed.hpp"
#include "tests/support/process.hpp"

namespace hapticast::testing {

class NatsServer {
 public:
  /// Whether the program is installed.
  [[nodiscard]] static bool exists() { return isInstalled("nats-server"); }
  /// Starts it in `folder`; `settings`: further lines of its configuration file.
  NatsServer(std::string folder, const std::string& settings) : folder_(std::move(folder)) {
    start("-1", settings);
    (void)waitUntil(std::chrono::seconds(60), [this] { return readPort(); });
  }
  /// Starts it again on the same port, with other settings, after kill().
  void restart(const std::string& settings) { start(port_, settings); }
  void kill() {
    process_->signal(SIGKILL);
    (void)process_->wait(std::chrono::seconds(60));
  }
  [[nodiscard]] std::string host() const { return "127.0.0.1:" + port_; }
  /// The address of a channel on it.
  [[nodiscard]] std::string channel(const std::string& name) const {
    return "nats://" + host() + "/" + name;
  }
  [[nodiscard]] Process& process() { return *process_; }

 private:
  void start(const std::string& port, const std::string& settings) {
    const std::string file = folder_ + "/nats.conf";
    std::ofstream(file) << "host: 127.0.0.1\nport: " << port << "\nports_file_dir: \"" << folder_
                        << "\"\n"
                        << settings;
    process_ = std::make_unique<Process>(
        std::vector<std::string>{"/usr/bin/env", "nats-server", "-c", file});
  }
  /// The ports file says {"nats":["nats://127.0.0.1:PORT"]}.
  bool readPort() {
    std::ifstream in(folder_ + "/nats-server_" + std::to_string(process_->id()) + ".ports");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::size_t at = text.find("127.0.0.1:");
    const std::size_t end = text.find('"', at == std::string::npos ? 0 : at);
    if (at == std::string::npos || end == std::string::npos) return false;
    port_ = text.substr(at + 10, end - at - 10);
    return true;
  }

  std::string folder_;
  std::string port_;
  std::unique_ptr<Process> process_;
};

}  // namespace hapticast::testing
