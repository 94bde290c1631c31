// SPDX-License-Identifier: MIT
#include "tests/evaluate/report_csv.hpp"

#include <charconv>
#include <fstream>
#include <set>
#include <stdexcept>
#include <tuple>

#include "tests/evaluate/report_plot.hpp"

namespace hapticast::evaluate {

namespace {

constexpr const char* kColumns = "scene,stage,variant,error,unit,time_us,is_default,is_thesis";
constexpr std::size_t kColumnCount = 8;

// A field of a CSV line; none of ours has quotes in it.
std::string quoteField(const std::string& text) {
  return text.find(',') == std::string::npos ? text : '"' + text + '"';
}

// A quotation mark that is never closed leaves too few fields.
std::vector<std::string> splitFields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool in_quotes = false;
  for (const char c : line) {
    if (c == '"') {
      in_quotes = !in_quotes;
    } else if (c == ',' && !in_quotes) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

double parseNumber(const std::string& field) {
  double value = 0.0;
  const char* const end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, value);
  if (error != std::errc() || stop != end) throw std::runtime_error("'" + field + "' is no number");
  return value;
}

bool parseFlag(const std::string& field) {
  if (field != "0" && field != "1") throw std::runtime_error("'" + field + "' is neither 0 nor 1");
  return field == "1";
}

Row parseRow(const std::string& line) {
  const std::vector<std::string> fields = splitFields(line);
  if (fields.size() != kColumnCount) {
    throw std::runtime_error(std::to_string(fields.size()) + " fields instead of " +
                             std::to_string(kColumnCount));
  }
  return {fields[0],
          fields[1],
          fields[2],
          parseNumber(fields[3]),
          fields[4],
          parseNumber(fields[5]),
          parseFlag(fields[6]),
          parseFlag(fields[7])};
}

}  // namespace

void writeRows(const std::filesystem::path& path, const std::vector<Row>& rows) {
  std::ofstream file(path);
  if (!file) throw std::runtime_error("--out: cannot write " + path.string());
  file << kColumns << '\n';
  for (const Row& row : rows) {
    file << quoteField(row.scene) << ',' << quoteField(row.stage) << ',' << quoteField(row.variant)
         << ',' << number(row.error) << ',' << quoteField(row.unit) << ',' << number(row.time_us)
         << ',' << row.is_default << ',' << row.is_thesis << '\n';
  }
}

std::vector<Row> readRows(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  std::vector<Row> rows;
  std::set<std::tuple<std::string, std::string, std::string>> seen;
  std::string line;
  for (int at = 1; std::getline(file, line); ++at) {
    try {
      if (at == 1) {
        if (line != kColumns)
          throw std::runtime_error(std::string("the columns are not ") + kColumns);
        continue;
      }
      rows.push_back(parseRow(line));
      const Row& row = rows.back();
      if (!seen.emplace(row.scene, row.stage, row.variant).second)
        throw std::runtime_error("the same figure twice");
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(path.string() + ':' + std::to_string(at) + ": " + error.what());
    }
  }
  return rows;
}

}  // namespace hapticast::evaluate
