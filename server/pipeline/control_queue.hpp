// SPDX-License-Identifier: MIT
// Requests of operators that wait for the thread of the stream. All waiting requests are merged
// into one: of each field the last value counts. So a flood of requests costs one seek. Thread:
// any.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "common/protocol/messages.hpp"

namespace hapticast::server {

/// Replaces the values of `material` by those that `change` has.
void changeMaterial(const Material& change, Material& material);

/// The merged requests of operators.
class ControlQueue {
 public:
  /// One request for several, and the functions that confirm each of them.
  struct Merged {
    Control request;
    std::vector<std::function<void()>> confirm;

    void confirmAll() const {
      for (const auto& each : confirm) each();
    }
  };

  /// Adds a request. The owner calls `confirm` once the request is carried out, or newer values
  /// have replaced all of its own.
  void push(const Control& request, std::function<void()> confirm);
  /// Returns the merged request and removes it; nullopt if there is none.
  [[nodiscard]] std::optional<Merged> take();
  /// Returns whether a request waits.
  [[nodiscard]] bool waits() const;
  /// Returns whether a seek waits.
  [[nodiscard]] bool seekWaits() const;
  /// Returns the time of the seek that waits, and removes it from its request; nullopt if none
  /// waits.
  [[nodiscard]] std::optional<double> takeSeek();

 private:
  mutable std::mutex mutex_;
  Merged merged_;  // guarded by mutex_
};

}  // namespace hapticast::server
