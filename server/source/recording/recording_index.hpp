// SPDX-License-Identifier: MIT
// Reads a recording once, and lists its topics with the times and places of their images. It keeps
// no image. Thread: any.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/recording/mcap_reader.hpp"
#include "server/source/recording/image_message.hpp"
#include "server/source/recording/message_picture.hpp"

namespace hapticast::server {

/// Times and place of an image.
struct IndexedImage {
  std::int64_t stamp_ns = 0;  ///< that of its message; 0: none
  std::int64_t logged_ns = 0;
  McapPlace place;
};

/// A topic with images.
struct ImageTopic {
  std::string name;
  std::string type;  ///< name of the schema
  // Of its first readable image.
  ImageKind kind = ImageKind::kUnknown;
  std::string encoding;
  std::string frame_id;
  std::string problem;               ///< why `kind` is unknown, as a phrase
  std::vector<IndexedImage> images;  ///< in the order of the file
};

/// Content of a recording.
struct RecordingIndex {
  std::vector<ImageTopic> topics;  ///< in the order of their names
  /// Intrinsics by their topic: the first usable ones.
  std::map<std::string, CameraMessage> cameras;
  std::vector<std::string> other_topics;  ///< with their types: "/imu (sensor_msgs/msg/Imu)"
  std::string problem;  ///< why the file ends early, as a phrase; empty: it does not
};

/// Reads all messages of `reader`. Calls `progress` before each one.
[[nodiscard]] RecordingIndex indexRecording(McapReader& reader, const ReadProgress& progress);

/// Topics of colour and depth.
struct TopicPair {
  const ImageTopic* color = nullptr;
  const ImageTopic* depth = nullptr;
};

/// Returns the topics that `named` names, the value of --topics: "COLOR,DEPTH". If it is empty,
/// returns the only colour and the only depth of `index`. Throws SourceError that names `file`, the
/// topics and --topics.
[[nodiscard]] TopicPair chooseTopics(const RecordingIndex& index, const std::string& named,
                                     const std::string& file);

/// Returns the intrinsics of the colour topic `color`: those of the same namespace ("/camera" of
/// "/camera/image_raw" and "/camera/image_raw/compressed"), else the only ones. nullptr: there are
/// none, or several.
[[nodiscard]] const CameraMessage* findCamera(const RecordingIndex& index, std::string_view color);

}  // namespace hapticast::server
