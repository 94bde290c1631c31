// SPDX-License-Identifier: MIT
// Passes bytes and texts between the page and the core. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/time.hpp"

/// Exports a function of the core under its name. In the native build of the tests it is a function
/// of C++, because a name such as poll() is one of the system's there.
#ifdef __wasm__
#define WEB_EXPORT(name) extern "C" __attribute__((export_name(#name)))
#else
#define WEB_EXPORT(name)
#endif

namespace hapticast::client::web {

/// Return what the page wrote into input() last.
[[nodiscard]] std::span<const std::uint8_t> input();
[[nodiscard]] std::string inputText();
/// Set the bytes that the page reads at output(). Return their number.
std::size_t setOutput(std::vector<std::uint8_t> bytes);
std::size_t setOutput(std::string_view text);

/// Converts the page's clock, ms.
[[nodiscard]] LocalTime toLocal(double now_ms);

}  // namespace hapticast::client::web
