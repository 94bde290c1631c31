// SPDX-License-Identifier: MIT
// The depth of a clip in one array, NPY or NPZ: refused, or pictures of the size that it states,
// the same ones when they are read again.
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <utility>
#include <vector>

#include "server/source/picture/npy_stack.hpp"
#include "server/source/picture/npz_file.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::array {
namespace {

using namespace hapticast::server;

std::unique_ptr<ByteStream> openBytes(std::span<const std::uint8_t> bytes) {
  if (!isZip(bytes)) return std::make_unique<MemoryStream>(bytes);
  StreamResult result = openNpz(bytes);
  require(result.problem.empty() == (result.stream != nullptr));
  return std::move(result.stream);
}

/// Reads the first pictures, of few pixels. Returns whether each is whole.
std::vector<bool> readPictures(NpyStack& stack) {
  constexpr std::size_t kMost = 8;
  std::vector<bool> whole;
  while (whole.size() < kMost) {
    const auto picture = stack.next();
    if (!picture) break;
    require(picture->ok() != picture->image.empty());
    require(!picture->ok() || picture->image.size() == stack.size());
    whole.push_back(picture->ok());
  }
  require(whole.size() <= stack.count());
  return whole;
}

}  // namespace

HAPTICAST_FUZZ_TARGET("array") {
  auto stream = openBytes({data, size});
  if (!stream) return 0;
  try {
    NpyStack stack(std::move(stream), "array");
    require(sizeReadable(stack.size().width, stack.size().height));
    if (stack.size().area() > 100'000) return 0;  // slow to fill, and nothing new
    const std::vector<bool> first = readPictures(stack);
    stack.rewind();
    require(readPictures(stack) == first);
    stack.seek(stack.count() - 1);
    const auto last = stack.next();
    require(last.has_value() && !stack.next());
  } catch (const SourceError&) {
  }
  return 0;
}

}  // namespace hapticast::fuzz::array
