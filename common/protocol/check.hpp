// SPDX-License-Identifier: MIT
// Helper of the decoder that checks values. Thread: any, one object for each message.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire_error.hpp"
#include "common/wire_limits.hpp"

namespace hapticast {

/// Checks values and records the first error. So the decoder reads all values without branches, and
/// calls error() once, at the end.
class Check {
 public:
  /// Returns `value`. Records the error `what` unless low <= value <= high. A NaN is an error.
  double number(double value, double low, double high, const char* what) {
    require(value >= low && value <= high, what);
    return value;
  }
  /// Returns `value`. Records the error `what` unless |value| <= limit.
  double magnitude(double value, double limit, const char* what) {
    return number(value, -limit, limit, what);
  }
  Duration time(std::int64_t ns) {
    require(ns >= -limits::kTime_ns && ns <= limits::kTime_ns, "a time is out of range");
    return Duration(ns);
  }
  void require(bool holds, const char* what) {
    if (!holds && !error_) error_ = malformed(what);
  }
  /// Records an error with the code kTooLarge unless size <= limit.
  void bound(std::size_t size, std::size_t limit, const char* what) {
    if (size > limit && !error_) error_ = WireError{ErrorCode::kTooLarge, what};
  }
  /// Records the error of another check.
  void adopt(const WireError& error) {
    if (!error_) error_ = error;
  }
  [[nodiscard]] const std::optional<WireError>& error() const { return error_; }

 private:
  std::optional<WireError> error_;
};

}  // namespace hapticast
