// SPDX-License-Identifier: MIT
// The journal of a study: what was written comes back, and an interrupted write leaves no trace.
#include "client/study/events_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "client/study/motion_file.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::client {
namespace {

TrialRow makeRow(std::mt19937& random) {
  const auto number = [&random] { return std::uniform_real_distribution(0.0, 100.0)(random); };
  TrialRow row{.onset_s = 1.25, .duration_s = 3.5, .is_training = random() % 2 == 0};
  row.trial = 1 + random() % 5000;
  row.condition = "B";
  if (random() % 2 == 0) row.comparison_interval = static_cast<int>(1 + random() % 2);
  if (random() % 2 == 0) row.level = number();
  if (random() % 3 != 0) row.answer = number();
  if (random() % 2 == 0) row.is_correct = random() % 2 == 0;
  if (random() % 2 == 0) row.response_time_s = number();
  row.status = row.answer ? "valid" : "stopped";
  row.wall_clock = "2026-11-29T08:21:41.933966Z";
  return row;
}

std::string makeFile(const TempFolder& folder, const std::vector<TrialRow>& rows) {
  std::string file = (folder / "events.tsv").string();
  EventsFile events(file, false);
  for (const TrialRow& row : rows) events.append(row);
  return file;
}

TEST(EventsFile, ReturnsTheRowsThatWereWritten) {
  const TempFolder folder;
  std::mt19937 random(4);
  std::vector<TrialRow> rows(200);
  for (TrialRow& row : rows) row = makeRow(random);
  const std::string file = makeFile(folder, rows);
  EXPECT_EQ(EventsFile(file, true).rows(), rows);
}

TEST(EventsFile, DropsARowThatAnInterruptionCut) {
  const TempFolder folder;
  std::mt19937 random(5);
  const std::vector<TrialRow> rows{makeRow(random), makeRow(random), makeRow(random)};
  const std::string file = makeFile(folder, rows);
  const auto size = std::filesystem::file_size(file);
  const std::size_t last = toLine(rows[2]).size();
  for (std::size_t cut = 1; cut <= last; ++cut) {
    std::filesystem::resize_file(file, size - cut);
    EventsFile events(file, true);
    ASSERT_EQ(events.rows().size(), 2U) << cut;
    events.append(rows[2]);
  }
  EXPECT_EQ(EventsFile(file, true).rows(), rows);
}

TEST(EventsFile, RefusesASecondRunAndASecondProgram) {
  const TempFolder folder;
  const std::string file = makeFile(folder, {});
  EXPECT_THROW(EventsFile(file, false), std::runtime_error);
  EXPECT_THROW(EventsFile((folder / "none.tsv").string(), true), std::runtime_error);
  const EventsFile open(file, true);
  EXPECT_THROW(EventsFile(file, true), std::runtime_error);
}

TEST(EventsFile, RefusesRowsThatItDidNotWrite) {
  for (const char* wrong : {"", "1\t2", "1\t2\tmain\t0\tA\tn/a\tn/a\t1\tn/a\tn/a\tvalid\tx",
                            "1\t2\tmain\t1\tA\t3\tn/a\t1\tn/a\tn/a\tvalid\tx",
                            "1\t2\tother\t1\tA\tn/a\tn/a\t1\tn/a\tn/a\tvalid\tx",
                            "1\t2\tmain\t1\tA\tn/a\tn/a\tn/a\tn/a\tn/a\tvalid\tx",
                            "1\t2\tmain\t1\tA\tn/a\tn/a\t1\tn/a\tn/a\tvalid\tx\ty"})
    EXPECT_FALSE(parseRow(wrong).ok()) << wrong;
  const TempFolder folder;
  const std::string file = makeFile(folder, {});
  std::ofstream(file, std::ios::app) << "what is this\n";
  EXPECT_THROW(EventsFile(file, true), std::runtime_error);
}

TEST(MotionFile, ContinuesAfterItsLastCompleteRow) {
  const TempFolder folder;
  const std::string file = (folder / "motion.tsv").string();
  TickReport report;
  report.hip_mm = {1.0, -2.0, 3.0};
  report.contact = true;
  {
    MotionFile motion(file);
    for (int i = 0; i < 5; ++i) motion.append(report, 0.001 * i);
  }
  const auto size = std::filesystem::file_size(file);
  EXPECT_LE(size, 5 * kMotionRow_bytes);
  for (std::uintmax_t cut = 1; cut < 30; ++cut) {
    std::filesystem::resize_file(file, size - cut);
    MotionFile motion(file);
    motion.append(report, 0.004);
    motion.flush();
    ASSERT_EQ(std::filesystem::file_size(file), size) << cut;
  }
  EXPECT_THROW(MotionFile("/nowhere/motion.tsv"), std::runtime_error);
}

}  // namespace
}  // namespace hapticast::client
