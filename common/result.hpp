// SPDX-License-Identifier: MIT
// Result of a function: a value or an error. Code that parses data from outside returns it in place
// of exceptions. Thread: any.
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace hapticast {

/// An error, described in one sentence.
struct Error {
  std::string message;
};

/// A value or an error. `Failure` is Error, or a type with an error code. value() requires ok(),
/// and error() requires !ok().
template <class T, class Failure = Error>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}        // NOLINT(google-explicit-constructor)
  Result(Failure error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return content_.index() == 0; }
  [[nodiscard]] T& value() & { return std::get<0>(content_); }
  [[nodiscard]] const T& value() const& { return std::get<0>(content_); }
  [[nodiscard]] T&& value() && { return std::get<0>(std::move(content_)); }
  [[nodiscard]] const Failure& error() const { return std::get<1>(content_); }

 private:
  std::variant<T, Failure> content_;
};

}  // namespace hapticast
