// SPDX-License-Identifier: MIT
// The file that commands the driver of OpenNI2 (tests/openni/driver.cpp). Thread: one.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>

namespace hapticast::testing {

/// Orders to the driver, in a file of the test's own.
class OpenniOrders {
 public:
  explicit OpenniOrders(std::string file) : file_(std::move(file)) { order({}); }

  [[nodiscard]] const std::string& file() const { return file_; }
  /// Gives orders that differ from the driver's defaults; earlier ones stay.
  void order(const std::map<std::string, int>& orders) {
    for (const auto& [key, value] : orders) orders_[key] = value;
    std::ostringstream text;
    for (const auto& [key, value] : orders_) text << key << " " << value << "\n";
    // A reader finds the whole old text or the whole new one.
    std::ofstream(file_ + ".new") << text.str();
    std::filesystem::rename(file_ + ".new", file_);
  }
  /// What the driver was asked for.
  [[nodiscard]] std::string calls() const {
    std::ostringstream text;
    text << std::ifstream(file_ + ".calls").rdbuf();
    return text.str();
  }

 private:
  std::string file_;
  std::map<std::string, int> orders_;
};

}  // namespace hapticast::testing
