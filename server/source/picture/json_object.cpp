// SPDX-License-Identifier: MIT
#include "server/source/picture/json_object.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "common/text.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

Json parseObject(std::string_view text, std::size_t most_bytes) {
  if (text.size() > most_bytes) return nullptr;
  bool too_deep = false;
  const auto bounded = [&](int depth, Json::parse_event_t event, Json&) {
    const bool opens =
        event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start;
    too_deep = too_deep || (opens && depth >= kMaxJsonDepth);
    return !too_deep;
  };
  Json out = Json::parse(text.begin(), text.end(), bounded, /*allow_exceptions=*/false);
  if (too_deep || !out.is_object()) return nullptr;
  return out;
}

std::string jsonText(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Members::Members(const Json& object, const std::string& name, std::string prefix)
    : object_(object), name_(name), prefix_(std::move(prefix)) {}

const Json& Members::at(const char* key) const {
  static const Json kNone;
  const auto member = object_.find(key);
  return member == object_.end() ? kNone : *member;
}

std::optional<double> Members::number(const char* key, double low, double high) const {
  const Json& value = at(key);
  if (value.is_null()) return std::nullopt;
  const std::string text = jsonText(value);
  const auto number = parseNumber(text);
  if (number && *number >= low && *number <= high) return number;
  throw SourceError(fmt::format("{}: \"{}{}\" is {}, where a number from {} to {} is expected",
                                name_, prefix_, key, quote(text), low, high));
}

std::vector<double> Members::numbers(const char* key, std::size_t count, double low,
                                     double high) const {
  const Json& value = at(key);
  std::vector<double> out;
  const auto fits = [low, high](const Json& item) {
    return item.is_number() && item.get<double>() >= low && item.get<double>() <= high;
  };
  if (!value.is_array() || value.size() < count || !std::all_of(value.begin(), value.end(), fits)) {
    throw SourceError(
        fmt::format("{}: \"{}{}\" is {}; expected are {} numbers from {} to {}", name_, prefix_,
                    key, value.is_null() ? "missing" : "something else", count, low, high));
  }
  for (const Json& item : value) out.push_back(item.get<double>());
  return out;
}

}  // namespace hapticast::server
