// SPDX-License-Identifier: MIT
// parseStudy() and parseRow(): any text is read or refused. A study that was read has trials, and
// a row survives a round trip.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "client/study/events_file.hpp"
#include "client/study/study_file.hpp"
#include "client/study/trial_schedule.hpp"
#include "common/json/json_error.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::study {
namespace {

void checkStudy(std::string_view text) {
  using namespace hapticast::client;
  try {
    const Study study = parseStudy(text);
    TrialSchedule schedule(study, "07");
    for (int i = 0; i < 5 && schedule.findTrial(); ++i) {
      if (schedule.findTrial()->condition >= study.conditions.size()) std::abort();
      i % 2 == 0 ? schedule.onVoid() : schedule.onAnswer(true);
    }
  } catch (const JsonError& error) {
    const auto lines = 1 + std::count(text.begin(), text.end(), '\n');
    if (error.place.line < 1 || error.place.line > lines || *error.what() == '\0') std::abort();
  }
}

}  // namespace

HAPTICAST_FUZZ_TARGET("study") {
  using namespace hapticast::client;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  checkStudy(text);
  const auto row = parseRow(text);
  if (!row.ok() || text.find('\n') != std::string_view::npos) return 0;
  std::string line = toLine(row.value());
  line.pop_back();
  const auto again = parseRow(line);
  if (!again.ok() || toLine(again.value()) != line + "\n") std::abort();
  return 0;
}

}  // namespace hapticast::fuzz::study
