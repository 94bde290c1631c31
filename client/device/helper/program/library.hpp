// SPDX-License-Identifier: MIT
// Loads a shared library of a device's manufacturer at run time, for a built-in driver. So the
// build needs neither the library nor its headers.
// Thread: main.
#pragma once

#include <initializer_list>
#include <string>

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// A loaded library. It remains loaded until the process ends, because its threads may still run
/// after a device is closed.
class Library {
 public:
  /// Loads the file of --device-option library=FILE, else the first of `names` that exists. `owner`
  /// is the manufacturer's product; the error message names it. Throws std::runtime_error (one
  /// line).
  Library(const hapticast_host& host, const std::string& owner,
          std::initializer_list<const char*> names);

  /// Sets `function` to the function `symbol`. Throws std::runtime_error (one line) if the library
  /// lacks it.
  template <class Function>
  void require(Function*& function, const char* symbol) const {
    find(function, symbol);
    if (function == nullptr) refuse(symbol);
  }
  /// Sets `function` to the function `symbol`, or to null if the library lacks it.
  template <class Function>
  void find(Function*& function, const char* symbol) const noexcept {
    function = reinterpret_cast<Function*>(findSymbol(symbol));
  }

 private:
  [[nodiscard]] void* findSymbol(const char* symbol) const noexcept;
  [[noreturn]] void refuse(const char* symbol) const;

  std::string owner_;
  std::string file_;
  void* handle_ = nullptr;
};

}  // namespace hapticast::client
