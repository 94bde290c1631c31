// SPDX-License-Identifier: MIT
// Reads the messages of a recording of this project (proto/recording.md), whose types its reader
// lists: the playback of a stream, the replay of a run, the library. A channel counts by the name
// of its schema. The bytes are not trusted; the decoders check them. At the first damage the
// messages end. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "common/recording/mcap_reader.hpp"
#include "common/result.hpp"

namespace hapticast {

/// A type of messages. `Content` is a variant of all contents.
template <class Content>
struct ContentType {
  const char* schema;
  const char* name;  ///< in problem()
  Result<Content> (*decode)(std::span<const std::uint8_t>);
};

/// Decodes bytes by `decodeContent`, whose result is one of the contents. Use it for
/// ContentType::decode.
template <class Content, auto decodeContent>
[[nodiscard]] Result<Content> decodeAs(std::span<const std::uint8_t> bytes) {
  auto decoded = decodeContent(bytes);
  if (!decoded.ok()) return Error{decoded.error().message};
  return Content(std::move(decoded).value());
}

/// Returns the set of the type with the number `type`, a bit.
[[nodiscard]] constexpr unsigned setOf(std::size_t type) { return 1U << type; }

/// A recording that is open for reading.
template <class Content>
class TypedReader {
 public:
  /// At most 32 types. The list must outlive the reader.
  using Types = std::span<const ContentType<Content>>;

  /// Opens `file`. Calls `progress` and returns an error as McapReader::open() does.
  [[nodiscard]] static Result<TypedReader> open(const std::string& file, Types types,
                                                const ReadProgress& progress = {}) {
    return make(McapReader::open(file, progress), types);
  }
  /// Returns another reader of the same file, as McapReader::reopen() does.
  [[nodiscard]] Result<TypedReader> reopen() const { return make(file_.reopen(), types_); }

  /// Returns whether the file has a channel of one of the types in the set `types`.
  [[nodiscard]] bool has(unsigned types) const { return (found_ & types) != 0; }
  /// Returns the time of the last message.
  [[nodiscard]] std::uint64_t end_ns() const { return file_.end_ns(); }

  /// Returns the next message of the set `types`, with the number of its type as `channel`. Returns
  /// nullopt at the end, and once there is a problem().
  [[nodiscard]] std::optional<McapMessage> next(unsigned types) {
    while (problem_.empty()) {
      auto message = file_.next();
      if (!message) {
        problem_ = file_.problem();
        break;
      }
      const auto type = channels_.find(message->channel);
      if (type == channels_.end() || (setOf(type->second) & types) == 0) continue;
      message->channel = type->second;
      return message;
    }
    return std::nullopt;
  }
  /// Returns the content of a message of next(). If it is invalid, returns nullopt and sets the
  /// problem.
  [[nodiscard]] std::optional<Content> decode(const McapMessage& message) {
    const ContentType<Content>& type = types_[message.channel];
    auto decoded = type.decode(message.data);
    if (decoded.ok()) return std::move(decoded).value();
    problem_ = std::string("has an invalid ") + type.name + " (" + decoded.error().message + ")";
    return std::nullopt;
  }
  /// Continues at or before the first message of `time_ns` or later, as McapReader::seek() does.
  void seek(std::uint64_t time_ns) {
    file_.seek(time_ns);
    problem_.clear();
  }

  /// Ends the messages because of `problem`, a phrase, unless they have ended because of another.
  void setProblem(const std::string& problem) {
    if (problem_.empty()) problem_ = problem;
  }
  /// Returns why the messages end before the end of the file, as a phrase such as "is cut off";
  /// empty: they do not, or the end was not reached.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  /// Returns the error of a recording without `what`, with the problem.
  [[nodiscard]] Error makeLackError(const std::string& what) const {
    return {"has no " + what + (problem_.empty() ? "" : ": it " + problem_)};
  }

 private:
  TypedReader(McapReader file, Types types) : file_(std::move(file)), types_(types) {
    for (const auto& [id, channel] : file_.channels()) {
      for (std::uint16_t i = 0; i < types_.size() && channel.message_encoding == "protobuf"; ++i) {
        if (channel.schema.name != types_[i].schema) continue;
        channels_[id] = i;
        found_ |= setOf(i);
      }
    }
  }
  [[nodiscard]] static Result<TypedReader> make(Result<McapReader> file, Types types) {
    if (!file.ok()) return file.error();
    return TypedReader(std::move(file).value(), types);
  }

  McapReader file_;
  Types types_;
  std::map<std::uint16_t, std::uint16_t> channels_;  // number in the file -> number of the type
  unsigned found_ = 0;                               // set of the types of the channels
  std::string problem_;
};

}  // namespace hapticast
