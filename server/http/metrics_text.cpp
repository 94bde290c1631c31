// SPDX-License-Identifier: MIT
#include <fmt/core.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "common/text.hpp"
#include "server/http/figures.hpp"

namespace hapticast::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kIndent = 2;

/// Returns `text` as a label's value: valid UTF-8, with the format's escapes.
std::string escapeLabel(std::string_view text) {
  std::string escaped;
  for (const char each : sanitizeUtf8(text)) {
    if (each == '\\' || each == '"') escaped += '\\';
    escaped += each;
  }
  return escaped;
}

std::string writeLabels(const FigureLabels& labels) {
  std::string text;
  for (const auto& [label, content] : labels)
    text += fmt::format("{}{}=\"{}\"", text.empty() ? "{" : ",", label, escapeLabel(content));
  return labels.empty() ? "" : text + "}";
}

std::string writeNumber(const FigureValue& value) {
  if (const bool* const flag = std::get_if<bool>(&value)) return *flag ? "1" : "0";
  if (const double* const number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  return std::to_string(std::get<std::uint64_t>(value));
}

}  // namespace

std::string writePrometheus(const Metrics& metrics) {
  std::string text;
  std::string_view family;
  for (const Figure& each : listFigures(metrics)) {
    if (each.name != family)
      text += fmt::format("# HELP hapticast_{0} {2}\n# TYPE hapticast_{0} {1}\n", each.name,
                          each.type, each.help);
    family = each.name;
    text += fmt::format("hapticast_{}{}{} {}\n", each.name, each.suffix, writeLabels(each.labels),
                        writeNumber(each.value));
  }
  return text;
}

std::string writeStatus(const Metrics& metrics) {
  constexpr std::array kPhases{"scan", "wait_for_viewer", "stream", "pause", "on_demand", "seek"};
  Json json{{"version", metrics.version},
            {"stream", sanitizeUtf8(metrics.name)},
            {"health", findProblem(metrics).value_or("ok")}};
  if (metrics.pipeline) {
    json["pipeline"] = {{"phase", kPhases[static_cast<std::size_t>(metrics.pipeline->phase)]},
                        {"plan", Json::array()}};
  }
  if (metrics.relay) json["relay"]["role"] = metrics.relay->is_edge ? "edge" : "origin";
  for (const Figure& each : listFigures(metrics)) {
    if (each.json_pointer.empty()) continue;
    std::visit([&](auto value) { json[Json::json_pointer(each.json_pointer)] = value; },
               each.value);
  }
  return json.dump(kIndent) + "\n";
}

}  // namespace hapticast::server
