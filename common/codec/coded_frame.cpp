// SPDX-License-Identifier: MIT
#include "common/codec/coded_frame.hpp"

#include <numeric>

namespace hapticast {

std::size_t CodedRelief::bytes() const {
  return std::accumulate(
      slices.begin(), slices.end(), std::size_t{0},
      [](std::size_t sum, const SliceBytes& slice) { return sum + slice.size(); });
}

CodedFrame FrameCoder::code(const HapticFrame& frame, const SliceSettings& settings) {
  CodedFrame out{frame.epoch, frame.id, frame.media_time, {}};
  out.objects.reserve(frame.objects.size());
  std::map<ObjectKey, Known> now;
  for (const HapticObject& object : frame.objects) {
    const ObjectKey key = makeKey(object);
    std::shared_ptr<const CodedRelief> coded;
    if (const auto before = known_.find(key); object.relief && before != known_.end() &&
                                              before->second.relief == object.relief &&
                                              before->second.settings == settings) {
      coded = before->second.coded;
    } else if (object.relief) {
      coded = codeRelief(*object.relief, settings);
    }
    if (object.relief) now[key] = {object.relief, settings, coded};
    out.objects.push_back(replaceRelief(object, std::move(coded)));
  }
  known_ = std::move(now);
  return out;
}

std::shared_ptr<const CodedRelief> FrameCoder::codeRelief(const Relief& relief,
                                                          const SliceSettings& settings) {
  auto coded = std::make_shared<CodedRelief>();
  coded->rect = relief.rect;
  coded->slices = encoder_.encode(relief, settings);
  coded->slice_count = coded->slices.size();
  if (coded->slices.empty()) return nullptr;
  return coded;
}

}  // namespace hapticast
