// SPDX-License-Identifier: MIT
#include "server/source/recording/recording_index.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "common/text.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kMostListed = 20;  // chosen: topics in one line of the log

// Limit of the index's memory (32 B for an image). Chosen: four days at 30 frames/s.
constexpr std::size_t kMostImages = 10'000'000;

/// Builds the index, message by message.
class IndexBuilder {
 public:
  void add(const McapMessage& message, const McapChannel& channel, McapPlace place) {
    const auto type = findType(channel);
    if (!type) return;
    if (isCameraType(*type)) {
      if (cameras_.contains(channel.topic)) return;
      if (const auto camera = readCameraMessage(*type, message.data))
        cameras_.emplace(channel.topic, *camera);
      return;
    }
    ++images_;
    const auto image = readImageMessage(*type, message.data);
    ImageTopic& topic = topics_[channel.topic];
    topic.type = channel.schema.name;
    IndexedImage& indexed = topic.images.emplace_back();
    constexpr auto kMost_ns = std::uint64_t{std::numeric_limits<std::int64_t>::max()};
    indexed.logged_ns = static_cast<std::int64_t>(std::min(message.time_ns, kMost_ns));
    indexed.place = place;
    if (image.ok()) {
      indexed.stamp_ns = image.value().stamp_ns;
      if (topic.kind == ImageKind::kUnknown) describe(image.value(), topic);
    } else if (topic.problem.empty()) {
      topic.problem = image.error().message;
    }
  }

  [[nodiscard]] bool isFull() const { return images_ >= kMostImages; }

  /// Returns the index. `channels`: those of the file.
  RecordingIndex finish(const std::map<std::uint16_t, McapChannel>& channels) {
    RecordingIndex index;
    std::set<std::string> others;
    for (const auto& [id, channel] : channels) {
      if (topics_.contains(channel.topic)) continue;
      const std::string& schema = channel.schema.name;
      others.insert(channel.topic + " (" + (schema.empty() ? channel.message_encoding : schema) +
                    ")");
    }
    index.other_topics.assign(others.begin(), others.end());
    for (auto& [name, topic] : topics_) {
      topic.name = name;
      index.topics.push_back(std::move(topic));
    }
    index.cameras = std::move(cameras_);
    return index;
  }

 private:
  static void describe(const ImageMessage& image, ImageTopic& topic) {
    const KindResult found = findKind(image);
    topic.kind = found.kind;
    if (topic.kind == ImageKind::kUnknown && !topic.problem.empty()) return;
    topic.problem = found.problem;
    topic.encoding = image.encoding;
    topic.frame_id = image.frame_id;
  }

  std::map<std::string, ImageTopic> topics_;
  std::map<std::string, CameraMessage> cameras_;
  std::size_t images_ = 0;
};

/// Returns the words as a list; of a long one the first words and the number of the others.
std::string listWords(std::vector<std::string> words) {
  const std::size_t more = words.size() - std::min(words.size(), kMostListed);
  words.resize(words.size() - more);
  return join(words, ", ") + (more > 0 ? " and " + std::to_string(more) + " more" : "");
}

std::string listNames(const std::vector<const ImageTopic*>& topics) {
  std::vector<std::string> names;
  names.reserve(topics.size());
  for (const ImageTopic* topic : topics) names.push_back(topic->name);
  return names.empty() ? "none" : listWords(names);
}

/// Returns all topics with their types; those with images have their encoding or problem, too.
std::string listTopics(const RecordingIndex& index) {
  std::vector<std::string> words;
  for (const ImageTopic& topic : index.topics) {
    words.push_back(topic.name + " (" + topic.type + ", " +
                    (topic.problem.empty() ? topic.encoding : topic.problem) + ")");
  }
  words.insert(words.end(), index.other_topics.begin(), index.other_topics.end());
  return listWords(words);
}

std::vector<const ImageTopic*> findTopics(const RecordingIndex& index, ImageKind kind) {
  std::vector<const ImageTopic*> found;
  for (const ImageTopic& topic : index.topics)
    if (topic.kind == kind) found.push_back(&topic);
  return found;
}

/// Returns the topic `name`, which --topics names. Throws SourceError if it has no pictures of
/// `kind`.
const ImageTopic& findNamed(const RecordingIndex& index, const std::string& name, ImageKind kind,
                            const std::string& file) {
  const auto found = std::find_if(index.topics.begin(), index.topics.end(),
                                  [&name](const ImageTopic& topic) { return topic.name == name; });
  if (found == index.topics.end())
    throw SourceError("--topics: " + file + " has no images of the topic " + quote(name) +
                      "; its topics are " + listTopics(index));
  if (found->kind == kind) return *found;
  if (found->kind == ImageKind::kUnknown)
    throw SourceError("--topics: " + name + " of " + file + " " + found->problem);
  throw SourceError("--topics: " + name + " of " + file + " has " +
                    (found->kind == ImageKind::kColor ? "colours" : "depth") + " (" +
                    found->encoding + "); use --topics COLOR,DEPTH in this order");
}

/// Returns the namespace of a topic: "/camera" of "/camera/image_raw".
std::string_view cutName(std::string_view topic) {
  return topic.substr(0, std::min(topic.rfind('/'), topic.size()));
}

}  // namespace

RecordingIndex indexRecording(McapReader& reader, const ReadProgress& progress) {
  IndexBuilder builder;
  std::optional<McapMessage> message;
  while (!builder.isFull() && (message = reader.next())) {
    progress(reader.share());
    builder.add(*message, reader.channels().at(message->channel), reader.place());
  }
  RecordingIndex index = builder.finish(reader.channels());
  index.problem = builder.isFull() ? "has more images than can be played" : reader.problem();
  return index;
}

TopicPair chooseTopics(const RecordingIndex& index, const std::string& named,
                       const std::string& file) {
  if (const std::size_t comma = named.find(','); comma != std::string::npos)
    return {&findNamed(index, named.substr(0, comma), ImageKind::kColor, file),
            &findNamed(index, named.substr(comma + 1), ImageKind::kDepth, file)};
  if (!named.empty()) throw SourceError("--topics: " + quote(named) + " is not COLOR,DEPTH");
  const auto colors = findTopics(index, ImageKind::kColor);
  const auto depths = findTopics(index, ImageKind::kDepth);
  if (colors.empty() || depths.empty()) {
    throw SourceError(
        file + ": has no images of " +
        (colors.empty() ? (depths.empty() ? "colour and depth" : "colour") : "depth") +
        " that the server reads; its topics are " + listTopics(index));
  }
  if (colors.size() > 1 || depths.size() > 1) {
    throw SourceError(file +
                      ": it is not clear which topics belong together; name them with "
                      "--topics COLOR,DEPTH; colour is in " +
                      listNames(colors) + "; depth is in " + listNames(depths));
  }
  return {colors.front(), depths.front()};
}

const CameraMessage* findCamera(const RecordingIndex& index, std::string_view color) {
  const std::string_view near = cutName(color);
  for (const std::string_view place : {near, cutName(near)}) {
    for (const auto& [topic, camera] : index.cameras)
      if (!place.empty() && cutName(topic) == place) return &camera;
  }
  return index.cameras.size() == 1 ? &index.cameras.begin()->second : nullptr;
}

}  // namespace hapticast::server
