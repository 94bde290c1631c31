// SPDX-License-Identifier: MIT
// Lossless coder for masks. An edge is a pixel of a row at which the mask changes between inside
// and outside. The coder writes the position of each edge relative to an edge of the row above, as
// the two-dimensional fax code does (ITU-T T.6; format: proto/slices.md). One template encodes and
// decodes (range_coder.hpp). Thread: any.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "common/codec/slice/range_coder.hpp"

namespace hapticast::codec {

/// A change between outside and inside, at the pixel `at` of a row. `shift` is its distance from
/// the related edge of the row above, within -7..7. It is 0 if there is no related edge.
struct Edge {
  int at = 0;
  int shift = 0;
};
/// The edges of a row. The row begins outside the mask. The last edge is at the width of the row.
using EdgeRow = std::vector<Edge>;

/// Finds the edges of a row of `width` pixels and writes them to `out`.
inline void findEdges(const std::uint8_t* row, int width, EdgeRow& out) {
  out.clear();
  std::uint8_t inside = 0;
  for (int i = 0; i < width;) {
    std::uint64_t eight = 0;  // most pixels equal their neighbours
    if (i + 8 <= width) {
      std::memcpy(&eight, row + i, sizeof eight);
      if (eight == inside * 0x0101010101010101U) {
        i += 8;
        continue;
      }
    }
    for (const int end = std::min(i + 8, width); i < end; ++i) {
      if (row[i] == inside) continue;
      inside = row[i];
      out.push_back({i, 0});
    }
  }
  out.push_back({width, 0});
}

/// Encodes or decodes the mask of one slice, row by row.
class MaskCoder {
 public:
  explicit MaskCoder(int width) : width_(width), above_{{width, 0}} {}

  /// Encodes or decodes the next row, and returns its edges. An encoder encodes the edges `wanted`.
  /// A decoder ignores `wanted`.
  template <class Coder>
  const EdgeRow& row(Coder& coder, const EdgeRow& wanted) {
    row_.clear();
    int at = -1;
    std::size_t above = 0;
    std::size_t next = 0;  // index into `wanted`
    bool inside = false;
    bool lost = false;  // the last edge had no counterpart in the row above
    while (at < width_) {
      while (above > 0 && above_[above - 1].at > at) --above;
      while (above < above_.size() &&
             (above_[above].at <= at || (above & 1U) != (inside ? 1U : 0U)))
        ++above;
      const Edge first = above < above_.size() ? above_[above] : Edge{width_, 0};
      const int second = above + 1 < above_.size() ? above_[above + 1].at : width_;
      const int target = Coder::kDecodes ? 0 : next < wanted.size() ? wanted[next].at : width_;
      const Edge edge = this->edge(coder, at, first, second, target, inside, lost);
      at = edge.at;
      if (lost && edge.shift == kPassed) continue;
      row_.push_back(edge);
      ++next;
      inside = !inside;
    }
    if (row_.empty() || row_.back().at != width_) row_.push_back({width_, 0});
    row_.back().shift = 0;
    std::swap(row_, above_);
    return above_;
  }

 private:
  static constexpr int kFarthest = 7;
  /// Special value of Edge::shift: the edge of the row above ends there. This row has no edge that
  /// continues it.
  static constexpr int kPassed = 99;

  template <class Coder>
  Edge edge(Coder& coder, int at, Edge first, int second, int target, bool inside, bool& lost) {
    const bool passes = second < target;
    const bool near = !passes && std::abs(target - first.at) <= kFarthest;
    const std::size_t k = lost ? 5 : static_cast<std::size_t>(std::clamp(first.shift, -2, 2) + 2);
    if (!coder.bit(distance_[k], !near)) {
      const int usual = std::abs(first.shift) >= 2 ? first.shift : 0;
      lost = false;
      const int shift = codeNumber(coder, shift_[k], target - first.at - usual) + usual;
      return {place(first.at + shift, at), std::clamp(shift, -kFarthest, kFarthest)};
    }
    lost = true;
    if (coder.bit(pass_[inside ? 1 : 0], passes)) return {second, kPassed};
    return {place(at + codeMagnitude(coder, run_, nullptr, target - at), at), 0};
  }

  [[nodiscard]] int place(int wanted, int at) const {
    return std::min(width_, std::max({wanted, 0, at + 1}));
  }

  int width_;
  EdgeRow above_, row_;
  std::array<BitModel, 6> distance_;
  std::array<NumberModel, 6> shift_;
  std::array<BitModel, 2> pass_;
  NumberModel run_;
};

}  // namespace hapticast::codec
