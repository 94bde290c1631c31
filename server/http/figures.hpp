// SPDX-License-Identifier: MIT
// The table of figures that the HTTP port shows: /metrics and /status.json write it in their
// formats. Thread: any.
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

/// One figure. Figures of one family follow each other.
struct Figure {
  std::string_view name;  ///< family in Prometheus, without hapticast_
  std::string_view type;  ///< gauge, counter or summary
  std::string_view help;  ///< one sentence
  FigureLabels labels;
  std::string_view suffix;   ///< of a summary's sum or count, else empty
  std::string json_pointer;  ///< place in /status.json (RFC 6901); empty: it is not there
  FigureValue value;
};

/// Returns the figures of `metrics` that the server has.
[[nodiscard]] std::vector<Figure> listFigures(const Metrics& metrics);

}  // namespace hapticast::server
