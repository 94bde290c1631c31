// SPDX-License-Identifier: MIT
// Access tokens (--tokens): secrets with which clients may connect, as viewer or operator. The file
// has the SHA-256 of each token, not the token itself. Thread: any; at most one at a time for each
// object.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "common/transport/signature.hpp"
#include "server/stream/limited_log.hpp"

namespace hapticast::server {

/// Rights of a token.
enum class Role : std::uint8_t {
  kViewer,    ///< receives the stream
  kOperator,  ///< may also pause, seek and change the material
};

/// A token of the list.
struct Grant {
  KeyBytes digest{};  ///< SHA-256 of the token
  Role role = Role::kViewer;
  std::optional<std::chrono::sys_days> last_day;  ///< last day of its validity, UTC; nullopt: none

  [[nodiscard]] bool expired(std::chrono::system_clock::time_point now) const {
    // In days: a time point of nanoseconds ends in the year 2262.
    return last_day && std::chrono::floor<std::chrono::days>(now) > *last_day;
  }
};

/// The tokens that a server accepts.
class AccessList {
 public:
  /// Returns the list in `text`. Each line is `SHA256 viewer|operator YYYY-MM-DD|never`; text after
  /// # is a comment. The last line ends with a newline, too: otherwise the text may be the begin of
  /// a file that is being written. Returns an error "LINE: reason" for another text. The reason has
  /// no word of the text, because the word may be a token.
  [[nodiscard]] static Result<AccessList> parse(std::string_view text);

  /// Returns the grant of `token`, even if it has expired. Returns nullopt for an unknown token.
  /// The run time does not depend on how many bytes of `token` are right, so that it reveals
  /// nothing about valid tokens.
  [[nodiscard]] std::optional<Grant> find(std::string_view token) const;
  /// Returns whether the list has the token of `grant` with the same role, and the token has not
  /// expired by the last day in the list.
  [[nodiscard]] bool permits(const Grant& grant, std::chrono::system_clock::time_point now) const;
  [[nodiscard]] std::size_t size() const { return grants_.size(); }

  static constexpr std::size_t kMostGrants = 10'000;

 private:
  std::vector<Grant> grants_;
};

/// Returns the list in `file`, which has at least one token. Writes a warning to `log` if other
/// users may read the file. Throws KeyFileError.
[[nodiscard]] AccessList loadAccessList(const std::string& file, LimitedLog& log);

}  // namespace hapticast::server
