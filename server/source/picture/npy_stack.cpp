// SPDX-License-Identifier: MIT
#include "server/source/picture/npy_stack.hpp"

#include <utility>

#include "common/text.hpp"
#include "server/source/picture/npz_file.hpp"

namespace hapticast::server {

namespace {

std::unique_ptr<ByteStream> openArray(const std::filesystem::path& file) {
  StreamResult result = hasEnding(file.string(), ".npz") ? openNpz(file) : openFileStream(file);
  if (!result.stream) throw SourceError(file.string() + ": " + result.problem);
  return std::move(result.stream);
}

}  // namespace

bool isArrayName(const std::filesystem::path& file) {
  return hasEnding(file.string(), ".npy") || hasEnding(file.string(), ".npz");
}

NpyStack::NpyStack(const std::filesystem::path& file) : NpyStack(openArray(file), file.string()) {}

NpyStack::NpyStack(std::unique_ptr<ByteStream> stream, std::string name)
    : stream_(std::move(stream)), name_(std::move(name)) {
  NpyHeaderResult result = readNpyHeader(*stream_, NpyShape::kStack);
  if (!result.problem.empty()) throw SourceError(name_ + ": " + result.problem);
  header_ = result.header;
}

std::optional<ImageResult> NpyStack::next() {
  if (next_ >= header_.count) return std::nullopt;
  const std::uint64_t index = next_++;
  if (!stream_->seek(header_.begin + index * header_.pictureBytes()))
    return ImageResult{{}, "is cut off or damaged"};
  return readNpyPicture(*stream_, header_);
}

bool NpyStack::skip() {
  if (next_ >= header_.count) return false;
  ++next_;
  return true;
}

}  // namespace hapticast::server
