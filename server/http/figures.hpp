// SPDX-License-Identifier: MIT
// Table of all figures (named values for operators) of the HTTP port. /metrics and /status.json
// format this table. Thread: any.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "server/http/metrics.hpp"

namespace hapticast::server {

using FigureLabels = std::vector<std::pair<std::string_view, std::string>>;
using FigureValue = std::variant<bool, std::uint64_t, double>;

/// One figure. Figures of one metric family are adjacent in the table.
struct Figure {
  std::string_view name;  ///< name of the metric family, without the prefix hapticast_
  std::string_view type;  ///< gauge, counter or summary
  std::string_view help;  ///< one sentence
  FigureLabels labels;
  std::string_view suffix;   ///< suffix of a summary's sum or count, else empty
  std::string json_pointer;  ///< place in /status.json (RFC 6901); empty: not in it
  FigureValue value;
};

/// Returns the figures of `metrics`, except those of parts that the server lacks (nullopt).
[[nodiscard]] std::vector<Figure> listFigures(const Metrics& metrics);

}  // namespace hapticast::server
