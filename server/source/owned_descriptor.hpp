// SPDX-License-Identifier: MIT
// A file descriptor with an owner. Thread: one at a time.
#pragma once

#include <unistd.h>

#include <utility>

namespace hapticast::server {

/// A file descriptor that is closed with its owner. Thread: one.
class OwnedDescriptor {
 public:
  explicit OwnedDescriptor(int number = -1) : number_(number) {}
  ~OwnedDescriptor() { close(); }
  OwnedDescriptor(OwnedDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  OwnedDescriptor& operator=(OwnedDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  /// Returns the number; -1: it is closed.
  [[nodiscard]] int get() const { return number_; }
  void close() {
    if (number_ >= 0) ::close(std::exchange(number_, -1));
  }

 private:
  int number_;
};

}  // namespace hapticast::server
