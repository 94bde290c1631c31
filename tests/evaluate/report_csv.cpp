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

std::string quoteField(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + '"';
}

// A quotation mark that is never closed leaves too few fields; two in quotes are one.
std::vector<std::string> splitFields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool in_quotes = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && in_quotes && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (c == '"') {
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

void writeTable(const std::filesystem::path& path, const Table& lines) {
  std::ofstream file(path);
  for (const std::vector<std::string>& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) file << (i > 0 ? "," : "") << quoteField(line[i]);
    file << '\n';
  }
  if (!file.flush()) throw std::runtime_error("--out: cannot write " + path.string());
}

Table readTable(const std::filesystem::path& path) {
  std::ifstream file(path);
  Table lines;
  for (std::string line; std::getline(file, line);) lines.push_back(splitFields(line));
  return lines;
}

void writeRows(const std::filesystem::path& path, const std::vector<Row>& rows) {
  Table lines{splitFields(kColumns)};
  for (const Row& row : rows) {
    lines.push_back({row.scene, row.stage, row.variant, number(row.error), row.unit,
                     number(row.time_us), row.is_default ? "1" : "0", row.is_thesis ? "1" : "0"});
  }
  writeTable(path, lines);
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
