// SPDX-License-Identifier: MIT
#include "server/source/picture/npy_array.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "common/text.hpp"
#include "server/source/picture/picture_size.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kMostHeader_bytes = 65'536;  // NumPy writes at most that into version 1
constexpr std::uint64_t kMostLength = 10'000'000;  // pictures of ninety hours

struct NpyType {
  std::string_view name;
  int type;
};
constexpr std::array<NpyType, 5> kNpyTypes{
    {{"|u1", CV_8UC1}, {"<u2", CV_16UC1}, {"<f2", CV_16FC1}, {"<f4", CV_32FC1}, {"<f8", CV_64FC1}}};

/// Returns the header's text, a Python dictionary; nullopt if the stream has no such header.
std::optional<std::string> readHeaderText(ByteStream& stream, std::uint64_t& begin) {
  std::array<std::uint8_t, 12> head{};
  const std::span bytes(head);
  if (!stream.read(bytes.first(8)) || !isNpy(bytes)) return std::nullopt;
  const std::uint8_t version = head[6];
  const std::size_t length_bytes = version == 1 ? 2 : 4;
  if (version < 1 || version > 3 || !stream.read(bytes.subspan(8, length_bytes)))
    return std::nullopt;
  std::size_t length = 0;
  for (std::size_t i = 0; i < length_bytes; ++i) length |= std::size_t{head[8 + i]} << (8 * i);
  if (length > kMostHeader_bytes) return std::nullopt;
  std::string text(length, '\0');
  if (!stream.read({reinterpret_cast<std::uint8_t*>(text.data()), text.size()}))
    return std::nullopt;
  begin = 8 + length_bytes + length;
  return text;
}

/// Returns the text between `begin` and `end` behind `key`.
std::string_view findNpyValue(std::string_view text, std::string_view key, char begin, char end) {
  const std::size_t at = text.find(key);
  const std::size_t from = at == std::string_view::npos ? at : text.find(begin, at + key.size());
  const std::size_t to = from == std::string_view::npos ? from : text.find(end, from + 1);
  return to == std::string_view::npos ? std::string_view() : text.substr(from + 1, to - from - 1);
}

/// Returns the lengths of the dimensions in "2, 3, 4" (each 1 or more); empty if one is none.
std::vector<std::uint64_t> parseShape(std::string_view text) {
  std::vector<std::uint64_t> lengths;
  while (!trim(text).empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto length =
        parseNumberInRange<std::uint64_t>(trim(text.substr(0, comma)), 1, kMostLength);
    if (!length) return {};
    lengths.push_back(*length);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return lengths;
}

std::string describeType(const std::string& name) {
  // 16-bit integers are mm, and floats are metres: a conversion keeps that.
  const bool integers = name.find_first_of("iub") != std::string::npos;
  return "has values of the type " + quote(name) + ", not |u1, <u2, <f2, <f4 or <f8; convert it " +
         (integers ? "(numpy: a.astype(np.uint16), in mm)" : "(numpy: a.astype(np.float32), in m)");
}

std::string describeShape(std::string_view shape, NpyShape wanted) {
  return "has the shape (" + sanitizeUtf8(shape, 60) + "), not " +
         (wanted == NpyShape::kMatrix
              ? "(height, width); save one matrix for each frame"
              : "(frames, height, width); save one array for the clip (numpy: np.stack(list))");
}

/// Sets what the text of the header states. Returns the problem, or "".
std::string parseText(std::string_view text, NpyShape shape, NpyHeader& header) {
  if (text.find("'fortran_order': False") == std::string_view::npos)
    return "is in the order of Fortran, not of C; convert it (numpy: np.ascontiguousarray(a))";
  const std::string name(findNpyValue(text, "'descr':", '\'', '\''));
  const auto* const type = std::find_if(kNpyTypes.begin(), kNpyTypes.end(),
                                        [&](const NpyType& known) { return known.name == name; });
  if (type == kNpyTypes.end()) return describeType(name);
  header.type = type->type;
  const std::string_view shape_text = findNpyValue(text, "'shape':", '(', ')');
  const std::vector<std::uint64_t> lengths = parseShape(shape_text);
  const std::size_t pictures = shape == NpyShape::kStack ? 1 : 0;
  if (lengths.size() != pictures + 2) return describeShape(shape_text, shape);
  if (pictures == 1) header.count = lengths[0];
  const auto height_px = static_cast<int>(lengths[pictures]);
  const auto width_px = static_cast<int>(lengths[pictures + 1]);
  if (!sizeReadable(width_px, height_px))
    return describeTooLarge(width_px, height_px) + "; scale it down";
  header.size = {width_px, height_px};
  return "";
}

}  // namespace

std::uint64_t NpyHeader::pictureBytes() const {
  return static_cast<std::uint64_t>(size.area()) * CV_ELEM_SIZE1(type);
}

bool isNpy(std::span<const std::uint8_t> bytes) { return toText(bytes).starts_with("\x93NUMPY"); }

NpyHeaderResult readNpyHeader(ByteStream& stream, NpyShape shape) {
  NpyHeader header;
  const auto text = readHeaderText(stream, header.begin);
  if (!text || text->find("'fortran_order':") == std::string::npos)
    return {{}, "is not a whole NPY array; save it anew (numpy: np.save)"};
  if (std::string problem = parseText(*text, shape, header); !problem.empty()) return {{}, problem};
  const std::uint64_t content = stream.size() - std::min(stream.size(), header.begin);
  // parseText() refuses a picture without bytes, which an analyzer does not see.
  const std::uint64_t whole = content / std::max<std::uint64_t>(header.pictureBytes(), 1);
  if (whole >= header.count) return {header, ""};
  std::string problem = "is cut off";
  if (shape == NpyShape::kStack)
    problem += " (it has " + std::to_string(whole) + " of " + std::to_string(header.count) +
               " pictures); save it anew";
  return {{}, problem};
}

ImageResult readNpyPicture(ByteStream& stream, const NpyHeader& header) {
  cv::Mat image(header.size, header.type);
  if (!stream.read({image.data, static_cast<std::size_t>(header.pictureBytes())}))
    return {{}, "is cut off or damaged"};
  if (header.type == CV_16FC1 || header.type == CV_64FC1) image.convertTo(image, CV_32F);
  return {image, ""};
}

ImageResult readNpyMatrix(ByteStream& stream) {
  const NpyHeaderResult result = readNpyHeader(stream, NpyShape::kMatrix);
  if (!result.problem.empty()) return {{}, result.problem};
  return readNpyPicture(stream, result.header);
}

}  // namespace hapticast::server
