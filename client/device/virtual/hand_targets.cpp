// SPDX-License-Identifier: MIT
// Reads the files with the targets of a scripted hand (hand_script.hpp).
#include <array>
#include <charconv>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "client/device/virtual/hand_script.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {
constexpr std::size_t kMostRows = 1'000'000;
constexpr std::size_t kLongestLine = 256;
constexpr double kLatest_s = 86'400.0;
constexpr double kFarthest_mm = 1000.0;

[[noreturn]] void fail(const std::string& file, std::size_t line, const std::string& what) {
  throw std::runtime_error(file + ":" + std::to_string(line) + ": " + what);
}

std::runtime_error makeUnreadableError(const std::string& file) {
  return std::runtime_error(file +
                            ": cannot be read (allowed are press, slide, follow, free or a file of "
                            "t_s,x_mm,y_mm,z_mm rows)" +
                            spellingHint(file, {"press", "slide", "follow", "free"}));
}

/// Parses four numbers separated by commas. Returns false if the row is invalid.
bool parseRow(std::string_view text, std::array<double, 4>& row) {
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < row.size(); ++i) {
    while (at != end && *at == ' ') ++at;
    const auto [next, error] = std::from_chars(at, end, row[i]);
    if (error != std::errc()) return false;
    at = next;
    while (at != end && *at == ' ') ++at;
    if (i + 1 < row.size() && (at == end || *at++ != ',')) return false;
  }
  return at == end;
}

HandTarget checkTarget(const std::array<double, 4>& row, const std::vector<HandTarget>& before,
                       const std::string& file, std::size_t line) {
  if (!(row[0] >= 0.0 && row[0] <= kLatest_s)) fail(file, line, "t_s is not from 0 to 86400");
  if (!before.empty() && row[0] <= before.back().t_s) fail(file, line, "t_s does not rise");
  const Vec3 position_mm(row[1], row[2], row[3]);
  if (!(position_mm.cwiseAbs().maxCoeff() <= kFarthest_mm) || !position_mm.allFinite()) {
    fail(file, line, "a position is not within -1000 to 1000 mm");
  }
  return {row[0], position_mm};
}
}  // namespace

std::vector<HandTarget> loadHandTargets(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw makeUnreadableError(file);
  return readHandTargets(in, file);
}

std::vector<HandTarget> readHandTargets(std::istream& in, const std::string& file) {
  std::vector<HandTarget> targets;
  std::array<char, kLongestLine + 1> buffer{};
  std::size_t line = 0;
  while (in.getline(buffer.data(), static_cast<std::streamsize>(buffer.size()))) {
    ++line;
    std::string_view text(buffer.data(), static_cast<std::size_t>(in.gcount()));
    if (!in.eof()) text.remove_suffix(1);  // the line break
    while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.remove_suffix(1);
    if (text.empty() || (line == 1 && text == "t_s,x_mm,y_mm,z_mm")) continue;
    std::array<double, 4> row{};
    if (!parseRow(text, row)) fail(file, line, "a row is four numbers: t_s,x_mm,y_mm,z_mm");
    if (targets.size() == kMostRows) fail(file, line, "more than a million rows");
    targets.push_back(checkTarget(row, targets, file, line));
  }
  if (!in.eof()) {
    if (in.bad()) throw makeUnreadableError(file);
    fail(file, line + 1, "longer than 256 characters");
  }
  if (targets.empty()) throw std::runtime_error(file + ": no rows of t_s,x_mm,y_mm,z_mm");
  return targets;
}

}  // namespace hapticast::client
