// SPDX-License-Identifier: MIT
// Reads JSON objects from outside within limits, and their members within ranges. Thread: any.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hapticast::server {

using Json = nlohmann::json;

inline constexpr int kMaxJsonDepth = 32;  ///< deepest nesting of objects and arrays

/// Returns the object in `text`. Returns null if the text is no JSON object, is longer than
/// `most_bytes` or is nested deeper than kMaxJsonDepth.
[[nodiscard]] Json parseObject(std::string_view text, std::size_t most_bytes);

/// Returns a value as its author wrote it: a string without quotes, any other value as JSON.
[[nodiscard]] std::string jsonText(const Json& value);

/// Range-checked members of one object of a file.
class Members {
 public:
  /// `object` (null: no members) and `name`, the file's name, must outlive Members. `prefix`: the
  /// object's name in error messages.
  Members(const Json& object, const std::string& name, std::string prefix);

  /// Returns null if the member is missing.
  [[nodiscard]] const Json& at(const char* key) const;
  /// Returns the number `key`; nullopt if it is missing. Throws SourceError if the member is no
  /// number from `low` to `high`.
  [[nodiscard]] std::optional<double> number(const char* key, double low, double high) const;
  /// Returns the array `key` of at least `count` numbers from `low` to `high`. Throws SourceError
  /// if the member is anything else.
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count, double low,
                                            double high) const;

 private:
  const Json& object_;
  const std::string& name_;
  std::string prefix_;
};

}  // namespace hapticast::server
