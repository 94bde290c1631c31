// SPDX-License-Identifier: MIT
#include "client/web/exports.hpp"

#include <cmath>

namespace hapticast::client::web {

namespace {

struct Buffers {
  std::vector<std::uint8_t> in, out;
};

Buffers& buffers() {
  static Buffers the_buffers;
  return the_buffers;
}

}  // namespace

std::span<const std::uint8_t> input() { return buffers().in; }

std::string inputText() { return {buffers().in.begin(), buffers().in.end()}; }

std::size_t setOutput(std::vector<std::uint8_t> bytes) {
  buffers().out = std::move(bytes);
  return buffers().out.size();
}

std::size_t setOutput(std::string_view text) {
  return setOutput(std::vector<std::uint8_t>(text.begin(), text.end()));
}

LocalTime toLocal(double now_ms) { return LocalTime(Duration(std::llround(now_ms * 1e6))); }

/// Returns the place for `size` bytes of the page.
WEB_EXPORT(webInput) std::uint8_t* webInput(std::size_t size) {
  buffers().in.resize(size);
  return buffers().in.data();
}
/// Return place and size of the last output.
WEB_EXPORT(webOutput) const std::uint8_t* webOutput() { return buffers().out.data(); }
WEB_EXPORT(outputSize) std::size_t outputSize() { return buffers().out.size(); }

}  // namespace hapticast::client::web
