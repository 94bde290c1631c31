// SPDX-License-Identifier: MIT
// Reads JSON from outside within limits, and names the place of each mistake. parseJson() follows
// the events of the parser, and stores line and column of each member. A JsonObject reads the
// members of one object. Each of its functions checks one member.
// Thread: one.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/json/json_error.hpp"

namespace hapticast {

struct JsonLimits {
  std::size_t most_bytes = std::size_t{1} << 20U;
  std::size_t most_levels = 8;  ///< of objects and lists in each other
};

/// A text, parsed. A place is stored for each member, and for each object in a list.
// The library checks itself by assertions when a value moves; it does not throw.
struct JsonDocument {                       // NOLINT(bugprone-exception-escape)
  nlohmann::json root;                      ///< an object
  std::map<std::string, JsonPlace> places;  ///< by JSON pointer such as "/conditions/0/name"
};

/// Parses an object. Throws JsonError if `text` is none, is beyond a limit, or has a key twice.
[[nodiscard]] JsonDocument parseJson(std::string_view text, const JsonLimits& limits = {});

/// Returns a value as its author wrote it: a string without quotes, any other value as JSON.
[[nodiscard]] std::string jsonText(const nlohmann::json& value);

/// One object of a document. The functions that read a member throw JsonError with its place if the
/// member is invalid. They return nothing if the member is missing. The document must outlive it.
class JsonObject {
 public:
  /// The root of `document`.
  explicit JsonObject(const JsonDocument& document);

  /// Returns the object `key`. Throws JsonError if it is missing or no object.
  [[nodiscard]] JsonObject object(const std::string& key);
  /// Returns the objects of the list `key`; none if it is missing. Throws JsonError if a member is
  /// no object, or if there are more than `most`.
  [[nodiscard]] std::vector<JsonObject> objects(const char* key, std::size_t most);
  /// Returns the value of `key`, or null if it is missing. A JSON null counts as missing.
  const nlohmann::json* read(const std::string& key);
  /// Returns a number from `least` to `most`. A text that is a number counts as one.
  std::optional<double> number(const char* key, double least, double most);
  /// Returns a whole number from `least` to `most`.
  std::optional<std::size_t> count(const char* key, std::size_t least, std::size_t most);
  /// Returns a list of at least `count` numbers from `least` to `most`. Throws JsonError if it is
  /// missing.
  std::vector<double> numbers(const char* key, std::size_t count, double least, double most);
  /// Returns a text of 1 to `most_bytes` bytes without control characters other than line feeds.
  std::optional<std::string> text(const char* key, std::size_t most_bytes);
  /// Returns the value in `choices` that the text `key` names.
  template <class Value>
  std::optional<Value> choice(const char* key, const std::map<std::string, Value>& choices);

  [[nodiscard]] const nlohmann::json& value() const { return *object_; }
  [[nodiscard]] bool has(const char* key) const { return object_->contains(key); }
  [[nodiscard]] JsonPlace place() const { return find(path_); }
  /// Throws JsonError at the member `key`: the key in quotes, and `what`.
  [[noreturn]] void refuse(const std::string& key, const std::string& what) const;
  /// Throws JsonError with "'KEY' WHAT" for the first member that no function has read. `others`:
  /// keys for the hint of a spelling.
  void refuseOthers(const char* what, const std::vector<std::string>& others = {}) const;

 private:
  JsonObject(const JsonDocument& document, const nlohmann::json& object,
             nlohmann::json::json_pointer path);
  [[noreturn]] void refuseChoice(const char* key, const std::vector<std::string>& names) const;
  /// Returns the place of the member `path`, or of the nearest one around it.
  [[nodiscard]] JsonPlace find(nlohmann::json::json_pointer path) const;

  const JsonDocument* document_;
  const nlohmann::json* object_;
  nlohmann::json::json_pointer path_;
  std::set<std::string> known_;
};

template <class Value>
std::optional<Value> JsonObject::choice(const char* key,
                                        const std::map<std::string, Value>& choices) {
  const nlohmann::json* const value = read(key);
  if (value == nullptr) return std::nullopt;
  const auto found = value->is_string() ? choices.find(value->get<std::string>()) : choices.end();
  if (found != choices.end()) return found->second;
  std::vector<std::string> names;
  names.reserve(choices.size());
  for (const auto& [name, unused] : choices) names.push_back(name);
  refuseChoice(key, names);
}

}  // namespace hapticast
