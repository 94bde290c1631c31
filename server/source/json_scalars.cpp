// SPDX-License-Identifier: MIT
#include "server/source/json_scalars.hpp"

#include <cctype>
#include <cstddef>

namespace hapticast::server {

namespace {

constexpr int kMaxDepth = 32;
constexpr std::size_t kMaxPath_bytes = 256;

/// Recursive descent; every function returns false at the first thing that is not JSON.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  bool document() { return peek() == '{' && value("", true, 0) && peek() == '\0'; }
  std::map<std::string, std::string> takeScalars() { return std::move(scalars_); }

 private:
  /// The next character that is not white space; '\0' at the end.
  char peek() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char wanted) {
    if (peek() != wanted) return false;
    ++at_;
    return true;
  }

  bool value(const std::string& path, bool keep, int depth) {
    if (depth > kMaxDepth || path.size() > kMaxPath_bytes) return false;
    std::string scalar;
    switch (peek()) {
      case '{':
        return members('{', '}', path, keep, depth);
      case '[':
        return members('[', ']', path, false, depth);
      case '"':
        if (!string(scalar)) return false;
        break;
      default:
        if (!bare(scalar)) return false;
    }
    if (keep) scalars_[path] = scalar;
    return true;
  }

  /// The inside of an object or an array.
  bool members(char open, char close, const std::string& path, bool keep, int depth) {
    if (!take(open)) return false;
    if (take(close)) return true;
    do {
      std::string key;
      if (open == '{' && (peek() != '"' || !string(key) || !take(':'))) return false;
      if (!value(path.empty() ? key : path + "." + key, keep, depth + 1)) return false;
    } while (take(','));
    return take(close);
  }

  bool string(std::string& out) {
    for (++at_; at_ < text_.size(); ++at_) {
      char c = text_[at_];
      if (c == '"') {
        ++at_;
        return true;
      }
      if (c == '\\') {
        if (++at_ >= text_.size()) return false;
        c = text_[at_];
        if (c == 'u') {
          if (text_.size() - at_ < 5) return false;
          at_ += 4;
          c = '?';
        }
      }
      out.push_back(c);
    }
    return false;
  }

  /// A number, true, false or null.
  bool bare(std::string& out) {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '-' && c != '+')
        break;
      out.push_back(c);
      ++at_;
    }
    return !out.empty();
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::map<std::string, std::string> scalars_;
};

}  // namespace

std::optional<std::map<std::string, std::string>> readJsonScalars(std::string_view text) {
  Reader reader(text);
  if (!reader.document()) return std::nullopt;
  return reader.takeScalars();
}

}  // namespace hapticast::server
