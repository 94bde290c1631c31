// SPDX-License-Identifier: MIT
#include "common/json/json_document.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "common/text.hpp"

namespace hapticast {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostPlaces_bytes = std::size_t{64} << 20U;  // chosen

/// Reads a text, and follows its lines and columns.
class PlaceIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  PlaceIterator(const char* at, JsonPlace& place) : at_(at), place_(&place) {}
  reference operator*() const { return *at_; }
  PlaceIterator& operator++() {
    const bool is_end = *at_++ == '\n';
    place_->line += is_end ? 1 : 0;
    place_->column = is_end ? 1 : place_->column + 1;
    return *this;
  }
  PlaceIterator operator++(int) {
    PlaceIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const PlaceIterator& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  JsonPlace* place_;
};

/// Follows the parser, and stores the places. `now` is behind the token of the event.
class PlaceCollector {
 public:
  PlaceCollector(JsonDocument& document, const JsonPlace& now, std::size_t most_levels)
      : document_(document), now_(now), most_levels_(most_levels) {}

  bool onEvent(Json::parse_event_t event, const Json& parsed) {
    using Event = Json::parse_event_t;
    switch (event) {
      case Event::key:
        levels_.back().name = parsed.get<std::string>();
        store(true, levels_.back().name.size() + 2);
        break;
      case Event::object_start:
      case Event::array_start:
        countElement();
        if (event == Event::object_start) store(false, 1);
        if (levels_.size() == most_levels_)
          throw JsonError(now_, fmt::format("has more than {} levels", most_levels_));
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
  /// Stores the place of the present member, whose token has `size` bytes. `is_key`: it must be
  /// new.
  void store(bool is_key, std::size_t size) {
    Json::json_pointer pointer;
    for (const Level& level : levels_) pointer /= level.name;
    const std::string path = pointer.to_string();
    stored_bytes_ += path.size();
    if (stored_bytes_ > kMostPlaces_bytes) throw JsonError(now_, "has too many or too long names");
    const JsonPlace place{now_.line, std::max(1, now_.column - static_cast<int>(size))};
    const bool is_new = document_.places.emplace(path, place).second;
    if (is_key && !is_new) throw JsonError(place, quote(levels_.back().name) + " appears twice");
  }

  JsonDocument& document_;
  const JsonPlace& now_;
  std::size_t most_levels_;
  std::size_t stored_bytes_ = 0;
  std::vector<Level> levels_;
};

bool isPrintable(const std::string& text) {
  return std::none_of(text.begin(), text.end(),
                      [](unsigned char c) { return (c < 0x20 && c != '\n') || c == 0x7F; });
}

}  // namespace

std::string describe(const std::string& name, const JsonError& error) {
  return fmt::format("{}:{}:{}: {}", name, error.place.line, error.place.column, error.what());
}

JsonDocument parseJson(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.most_bytes)
    throw JsonError({}, fmt::format("has more than {} bytes", limits.most_bytes));
  JsonDocument document;
  JsonPlace now;
  PlaceCollector collector(document, now, limits.most_levels);
  const auto on_event = [&collector](int, Json::parse_event_t event, Json& parsed) {
    return collector.onEvent(event, parsed);
  };
  try {
    document.root = Json::parse(PlaceIterator(text.data(), now),
                                PlaceIterator(text.data() + text.size(), now), on_event);
  } catch (const Json::parse_error&) {
    throw JsonError(now, "is no JSON from here on");
  } catch (const Json::exception&) {
    throw JsonError(now, "has a number that is too large");
  }
  if (!document.root.is_object()) throw JsonError({}, "is no JSON object");
  return document;
}

std::string jsonText(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

JsonObject::JsonObject(const JsonDocument& document)
    : JsonObject(document, document.root, Json::json_pointer()) {}

JsonObject::JsonObject(const JsonDocument& document, const Json& object, Json::json_pointer path)
    : document_(&document), object_(&object), path_(std::move(path)) {
  if (!object.is_object()) throw JsonError(place(), "is no JSON object {...}");
}

const Json* JsonObject::read(const std::string& key) {
  known_.insert(key);
  const auto value = object_->find(key);
  return value == object_->end() || value->is_null() ? nullptr : &*value;
}

JsonObject JsonObject::object(const std::string& key) {
  const Json* const value = read(key);
  if (value == nullptr || !value->is_object()) refuse(key, "is no JSON object {...}");
  return {*document_, *value, path_ / key};
}

std::vector<JsonObject> JsonObject::objects(const char* key, std::size_t most) {
  const Json* const list = read(key);
  if (list == nullptr) return {};
  if (!list->is_array() || list->size() > most)
    refuse(key, fmt::format("is no list with at most {} members", most));
  std::vector<JsonObject> objects;
  for (std::size_t i = 0; i < list->size(); ++i)
    objects.push_back({*document_, (*list)[i], path_ / std::string(key) / i});
  return objects;
}

std::optional<double> JsonObject::number(const char* key, double least, double most) {
  const Json* const value = read(key);
  if (value == nullptr) return std::nullopt;
  const auto number = value->is_number()   ? std::optional(value->get<double>())
                      : value->is_string() ? parseNumber(value->get<std::string>())
                                           : std::nullopt;
  if (number && *number >= least && *number <= most) return number;
  refuse(key, fmt::format("is no number from {:g} to {:g}", least, most));
}

std::optional<std::size_t> JsonObject::count(const char* key, std::size_t least, std::size_t most) {
  const auto value = number(key, static_cast<double>(least), static_cast<double>(most));
  if (!value) return std::nullopt;
  if (*value != std::floor(*value)) refuse(key, "is no whole number");
  return static_cast<std::size_t>(*value);
}

std::vector<double> JsonObject::numbers(const char* key, std::size_t count, double least,
                                        double most) {
  const Json* const value = read(key);
  const auto fits = [least, most](const Json& item) {
    return item.is_number() && item.get<double>() >= least && item.get<double>() <= most;
  };
  const bool valid = value != nullptr && value->is_array() && value->size() >= count &&
                     std::all_of(value->begin(), value->end(), fits);
  if (!valid)
    refuse(key, fmt::format("{} {} numbers from {:g} to {:g}",
                            value == nullptr ? "is missing; expected are" : "is no list of", count,
                            least, most));
  std::vector<double> out;
  for (const Json& item : *value) out.push_back(item.get<double>());
  return out;
}

std::optional<std::string> JsonObject::text(const char* key, std::size_t most_bytes) {
  const Json* const value = read(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_string()) {
    auto text = value->get<std::string>();
    if (!text.empty() && text.size() <= most_bytes && isPrintable(text)) return text;
  }
  refuse(key, fmt::format("is no text of 1 to {} bytes", most_bytes));
}

void JsonObject::refuse(const std::string& key, const std::string& what) const {
  throw JsonError(find(path_ / key), quote(key) + " " + what);
}

void JsonObject::refuseChoice(const char* key, const std::vector<std::string>& names) const {
  const Json& value = object_->at(key);
  refuse(key, "is none of " + join(names, ", ") +
                  (value.is_string() ? spellingHint(value.get<std::string>(), names) : ""));
}

void JsonObject::refuseOthers(const char* what, const std::vector<std::string>& others) const {
  std::vector<std::string> known(known_.begin(), known_.end());
  known.insert(known.end(), others.begin(), others.end());
  for (const auto& [key, unused] : object_->items()) {
    if (!known_.contains(key)) refuse(key, what + spellingHint(key, known));
  }
}

JsonPlace JsonObject::find(Json::json_pointer path) const {
  while (true) {
    const auto found = document_->places.find(path.to_string());
    if (found != document_->places.end()) return found->second;
    if (path.empty()) return {};
    path.pop_back();
  }
}

}  // namespace hapticast
