// SPDX-License-Identifier: MIT
#include "client/library/receive/frame_reader.hpp"

#include <utility>

namespace hapticast::client {

void FrameReader::beginFrame(const AssembledFrame& assembled, const Workspace& workspace) {
  if (workspace_ != workspace || assembled.place.resync) {
    reliefs_.reset(workspace, Method::kHapticast);
    workspace_ = workspace;
  }
  if (std::exchange(epoch_, assembled.place.epoch) != assembled.place.epoch) reliefs_.forget();
}

void FrameReader::skip(const AssembledFrame& assembled, const Workspace& workspace) {
  beginFrame(assembled, workspace);
  for (const CodedObject& object : assembled.frame.objects)
    reliefs_.remember(object, assembled.frame.id);
}

Frame FrameReader::read(const AssembledFrame& assembled, const Workspace& workspace) {
  beginFrame(assembled, workspace);
  const CodedFrame& from = assembled.frame;
  // The client-side epoch also changes at a new connection, and never repeats.
  HapticFrame frame{assembled.place.epoch, from.id, from.media_time, {}};
  frame.objects.reserve(from.objects.size());
  for (const CodedObject& object : from.objects) {
    frame.objects.push_back(replaceRelief(object, reliefs_.resolve(object, from.id).relief));
  }
  return exporter_.convert(frame);
}

}  // namespace hapticast::client
