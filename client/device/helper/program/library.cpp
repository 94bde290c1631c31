// SPDX-License-Identifier: MIT
#include "client/device/helper/program/library.hpp"

#include <dlfcn.h>

#include <fmt/core.h>
#include <stdexcept>

namespace hapticast::client {

namespace {

constexpr const char* kLibraryOption = "--device-option library=";

void* load(const std::string& file) { return dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL); }

/// Returns the reason of the last failure of dlopen().
std::string takeReason() {
  const char* const reason = dlerror();
  return reason == nullptr ? "unknown reason" : reason;
}

}  // namespace

Library::Library(const hapticast_host& host, const std::string& owner,
                 std::initializer_list<const char*> names)
    : owner_(owner) {
  if (const char* const chosen = host.option(host.self, "library")) {
    file_ = chosen;
    handle_ = load(file_);
    if (handle_ == nullptr)
      throw std::runtime_error(kLibraryOption + file_ + ": cannot be loaded: " + takeReason());
    return;
  }
  for (const char* const name : names) {
    file_ = name;
    handle_ = load(file_);
    if (handle_ != nullptr) return;
    // The text begins with the name of the missing file: another one is a library that it needs.
    const std::string reason = takeReason();
    if (!reason.starts_with(file_ + ": cannot open"))
      throw std::runtime_error(
          fmt::format("the library {} of {} cannot be loaded: {}", file_, owner, reason));
  }
  throw std::runtime_error(
      fmt::format("the library {} of {} was not found; install it or name it with {}FILE",
                  *names.begin(), owner, kLibraryOption));
}

void* Library::findSymbol(const char* symbol) const noexcept { return dlsym(handle_, symbol); }

void Library::refuse(const char* symbol) const {
  throw std::runtime_error("the library " + file_ + " lacks " + symbol + "(): is it the one of " +
                           owner_ + "?");
}

}  // namespace hapticast::client
