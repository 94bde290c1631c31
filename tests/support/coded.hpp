// SPDX-License-Identifier: MIT
// Frames between how they are made and how they travel, for tests.
#pragma once

#include <stdexcept>

#include "common/codec/coded_frame.hpp"

namespace hapticast::testing {

/// The finest slices there are: heights are wrong by 2 micrometres at most.
inline constexpr SliceSettings kFinestSlices{.error_mm = 0.002};

inline CodedFrame coded(const HapticFrame& frame, const SliceSettings& settings = kFinestSlices) {
  return FrameCoder().code(frame, settings);
}

/// One object coded alone.
inline CodedObject coded(const HapticObject& object) {
  HapticFrame frame;
  frame.objects.push_back(object);
  return coded(frame).objects.front();
}

/// A relief from its slices. Throws where one of them cannot be decoded.
inline Relief decodedRelief(const CodedRelief& from) {
  Relief relief = Relief::blank(from.rect);
  HeightDecoder decoder;
  for (const SliceBytes& slice : from.slices) {
    const auto covered = decoder.decode(slice, relief);
    if (!covered.ok()) throw std::runtime_error(covered.error().message);
  }
  return relief;
}

}  // namespace hapticast::testing
