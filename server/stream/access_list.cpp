// SPDX-License-Identifier: MIT
#include "server/stream/access_list.hpp"

#include <fmt/core.h>
#include <openssl/crypto.h>
#include <openssl/sha.h>

#include <array>
#include <charconv>
#include <sstream>
#include <utility>

#include "common/private_file.hpp"
#include "common/text.hpp"
#include "server/stream/key_file.hpp"

namespace hapticast::server {

namespace {

constexpr const char* kForm = "SHA256 viewer|operator YYYY-MM-DD|never";

std::optional<std::chrono::sys_days> parseDay(std::string_view text) {
  std::array<int, 3> parts{};
  constexpr std::array<std::size_t, 4> kEnds{4, 7, 10};
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  for (std::size_t i = 0, begin = 0; i < parts.size(); begin = kEnds[i] + 1, ++i) {
    const char* const end = text.data() + kEnds[i];
    if (std::from_chars(text.data() + begin, end, parts[i]).ptr != end) return std::nullopt;
  }
  const std::chrono::year_month_day day{std::chrono::year(parts[0]),
                                        std::chrono::month(static_cast<unsigned>(parts[1])),
                                        std::chrono::day(static_cast<unsigned>(parts[2]))};
  if (!day.ok()) return std::nullopt;
  return std::chrono::sys_days(day);
}

/// Returns the grant of a line without its comment; an empty text if the line is right.
std::string parseGrant(const std::string& line, Grant& grant) {
  std::istringstream words(line);
  std::string digest;
  std::string role;
  std::string day;
  std::string more;
  words >> digest >> role >> day >> more;
  // A word of a wrong line may be a token, so no error has one.
  const auto parsed = parseKey(digest);
  if (!parsed)
    return "the first word is no SHA-256 (64 hex digits); the file has digests, not tokens";
  if (role != "viewer" && role != "operator") return "the second word is not viewer or operator";
  const auto last_day = parseDay(day);
  if (!last_day && day != "never") return "the third word is not YYYY-MM-DD or never";
  if (!more.empty()) return "there are more than three words";
  grant = {*parsed, role == "operator" ? Role::kOperator : Role::kViewer, last_day};
  return "";
}

}  // namespace

Result<AccessList> AccessList::parse(std::string_view text) {
  AccessList list;
  std::istringstream in{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (in.eof())
      return Error{fmt::format("{}: the last line is not complete: end it with a newline", number)};
    line = line.substr(0, line.find('#'));
    if (trim(line).empty()) continue;
    Grant grant;
    if (const std::string problem = parseGrant(line, grant); !problem.empty())
      return Error{fmt::format("{}: {}; the form is {}", number, problem, kForm)};
    for (const Grant& other : list.grants_) {
      if (other.digest == grant.digest)
        return Error{fmt::format("{}: this token is in the file twice", number)};
    }
    if (list.grants_.size() == kMostGrants)
      return Error{fmt::format("{}: more than {} tokens", number, kMostGrants)};
    list.grants_.push_back(grant);
  }
  return list;
}

std::optional<Grant> AccessList::find(std::string_view token) const {
  KeyBytes digest{};
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
  std::optional<Grant> found;
  for (const Grant& grant : grants_) {
    if (CRYPTO_memcmp(grant.digest.data(), digest.data(), digest.size()) == 0) found = grant;
  }
  return found;
}

bool AccessList::permits(const Grant& grant, std::chrono::system_clock::time_point now) const {
  for (const Grant& known : grants_) {
    if (known.digest == grant.digest) return known.role == grant.role && !known.expired(now);
  }
  return false;
}

AccessList loadAccessList(const std::string& file, LimitedLog& log) {
  const auto text = readSmallFile(file);
  if (!text.ok())
    throw KeyFileError("--tokens " + file + ": " + text.error().message +
                       "; name a file with lines " + kForm);
  auto list = AccessList::parse(text.value());
  if (!list.ok()) throw KeyFileError("--tokens " + file + ":" + list.error().message);
  if (list.value().size() == 0)
    throw KeyFileError("--tokens " + file +
                       ": has no token, so no client could connect; add lines " + kForm);
  if (auto warning = findReaders("--tokens", file, "try tokens against it"))
    log.warn(std::move(*warning));
  return std::move(list).value();
}

}  // namespace hapticast::server
