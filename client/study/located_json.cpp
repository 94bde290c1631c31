// SPDX-License-Identifier: MIT
#include "client/study/located_json.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "common/text.hpp"

namespace hapticast::client {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostNesting = 8;  // chosen: twice what a study needs

/// Reads a text and counts its lines.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, int& line) : at_(at), line_(&line) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    if (*at_++ == '\n') ++*line_;
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  int* line_;
};

/// Follows the parser, and stores the lines.
class LineCollector {
 public:
  LineCollector(JsonLines& lines, const int& line) : lines_(lines), line_(line) {}

  bool onEvent(Json::parse_event_t event, const Json& parsed) {
    using Event = Json::parse_event_t;
    switch (event) {
      case Event::key:
        levels_.back().name = parsed.get<std::string>();
        store(true);
        break;
      case Event::object_start:
      case Event::array_start:
        countElement();
        if (event == Event::object_start) store(false);
        if (levels_.size() == kMostNesting) throw LocatedError(line_, "has more than 8 levels");
        levels_.push_back({.is_list = event == Event::array_start, .name = {}});
        break;
      case Event::object_end:
      case Event::array_end:
        levels_.pop_back();
        break;
      case Event::value:
        countElement();
        break;
    }
    return true;
  }

 private:
  struct Level {
    bool is_list = false;
    std::string name;
    std::size_t elements = 0;
  };
  void countElement() {
    if (levels_.empty() || !levels_.back().is_list) return;
    levels_.back().name = std::to_string(levels_.back().elements++);
  }
  /// Stores the line of the present member. `is_key`: it must be new.
  void store(bool is_key) {
    std::string path;
    for (const Level& level : levels_) path += "/" + level.name;
    const bool is_new = lines_.emplace(path, line_).second;
    if (is_key && !is_new) throw LocatedError(line_, quote(levels_.back().name) + " appears twice");
  }

  JsonLines& lines_;
  const int& line_;
  std::vector<Level> levels_;
};

}  // namespace

Json parseLocated(std::string_view text, JsonLines& lines) {
  int line = 1;
  LineCollector collector(lines, line);
  const auto on_event = [&collector](int, Json::parse_event_t event, Json& parsed) {
    return collector.onEvent(event, parsed);
  };
  try {
    Json out = Json::parse(CountingIterator(text.data(), line),
                           CountingIterator(text.data() + text.size(), line), on_event);
    if (out.is_object()) return out;
  } catch (const Json::parse_error&) {
    throw LocatedError(line, "is no JSON from here on");
  } catch (const Json::exception&) {
    throw LocatedError(line, "has a number that is too large");
  }
  throw LocatedError(1, "is no JSON object");
}

}  // namespace hapticast::client
