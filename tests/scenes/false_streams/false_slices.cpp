// SPDX-License-Identifier: MIT
// False streams with wrong slices of a relief: first bytes that contradict each other, and codes
// that mean something else than heights of this object.
#include <stdexcept>

#include "tests/scenes/false_streams/false_stream_parts.hpp"
#include "tests/support/coded.hpp"

namespace hapticast::testing {

namespace {

/// The plateau's slices in pieces, so that there are several.
CodedFrame pieces(const OutgoingFrame& t) {
  HapticFrame frame = t.frame;
  frame.objects.front().relief = shape([](double x, double y) {
    return 10.0 + 0.3 * std::sin(23.0 * x * y) + 0.1 * std::cos(90.0 * x);
  });
  frame.objects.front().changed_in_frame = frame.id;
  return coded(frame, {.error_mm = 0.002, .most_bytes = 300});
}

/// From the 30th frame on every frame's slices are changed, and it is sent so.
auto sliced(void (*change)(CodedRelief&, std::mt19937_64&)) {
  return [change](OutgoingFrame& t) {
    if (t.n < 30) return;
    CodedFrame frame = pieces(t);
    CodedRelief relief = *frame.objects.front().relief;
    if (relief.slices.size() < 2) throw std::logic_error("the plateau has to be in several slices");
    change(relief, t.random);
    frame.objects.front().relief = std::make_shared<CodedRelief>(std::move(relief));
    t.bytes = encode(frame);
  };
}

/// A slice over the whole plateau whose code is what it is.
SliceBytes wholePlateau(std::uint8_t mode) {
  return {static_cast<std::uint8_t>(mode << 4U | 15U), 0, 0, 15, 15, 163, 0};
}

template <std::uint8_t Mode>
void noise(CodedRelief& relief, std::mt19937_64& random) {
  relief.slices = {wholePlateau(Mode)};
  for (int i = 0; i < 1000; ++i)
    relief.slices.front().push_back(static_cast<std::uint8_t>(random()));
}

}  // namespace

FalseStreams slices() {
  return {
      {"slices_none", kHold, kRefused, sliced([](auto& relief, auto&) { relief.slices.clear(); })},
      {"slices_empty", kHold, kRefused,
       sliced([](auto& relief, auto&) { relief.slices.front().clear(); })},
      {"slices_100000_empty", kHold, kRefused,
       sliced([](auto& relief, auto&) { relief.slices.assign(100'000, {}); })},
      {"slices_too_long", kHold, kRefused,
       sliced([](auto& relief, auto&) { relief.slices.front().resize(kMostSliceBytes + 1); })},
      {"slices_overlap", kHold, kRefused,
       sliced([](auto& relief, auto&) { relief.slices.push_back(relief.slices.front()); })},
      {"slices_beyond_rectangle", kHold, kRefused,
       sliced([](auto& relief, auto&) { relief.slices.front()[3] = 200; })},
      {"slices_unknown_mode", kHold, kRefused,
       sliced([](auto& relief, auto&) { relief.slices.front()[0] = 0xF0; })},
      {"slices_no_step", kHold, kRefused, sliced([](auto& relief, auto&) {
         relief.slices.front()[5] = relief.slices.front()[6] = 0;
       })},
      {"slices_no_pixel", kHold, kRefused, sliced([](auto& relief, auto&) {
         relief.slices = {wholePlateau(0)};
         relief.slices.front().resize(60, 0xFF);
       })},
      {"slices_cut", kHold, kRefused, sliced([](auto& relief, auto&) {
         for (SliceBytes& slice : relief.slices) slice.resize(slice.size() / 3 + 7);
       })},
      {"slices_noise_smooth", kHold, kRefused, sliced(noise<0>)},
      {"slices_noise_rough", kHold, kRefused, sliced(noise<1>)},
      {"slices_flipped_bits", kHold, kRefused, sliced([](auto& relief, auto& random) {
         for (SliceBytes& slice : relief.slices)
           slice[7 + random() % (slice.size() - 7)] ^= static_cast<std::uint8_t>(random());
       })},
      {"slices_swapped_places", kHold, kHarmless, sliced([](auto& relief, auto& random) {
         const std::size_t other = 1 + random() % (relief.slices.size() - 1);
         // Their places stay; their contents are those of the other.
         for (std::size_t i = 7; i < std::min(relief.slices[0].size(), relief.slices[other].size());
              ++i)
           std::swap(relief.slices[0][i], relief.slices[other][i]);
       })},
  };
}

}  // namespace hapticast::testing
