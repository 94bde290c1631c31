// SPDX-License-Identifier: MIT
// The folder of a study's results: a dataset of BIDS 1.9 (Motion). README.md lists its files. A
// subject has no other data in it than the code.
// Thread: one.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "client/study/study.hpp"

namespace hapticast::client {

using WallTime = std::chrono::system_clock::time_point;

/// Returns `time` in UTC as "2026-11-29T08:00:12.123456Z".
[[nodiscard]] std::string formatIso8601(WallTime time);

/// What the files of a new subject state.
struct NewSubject {
  std::string study_text;          ///< the study file
  std::vector<std::string> codes;  ///< of the conditions
  std::string device;              ///< name of the device
  bool is_simulated = false;       ///< an observer answers in place of a subject
  WallTime start;                  ///< of the motion file
};

class StudyFolder {
 public:
  /// Names the files of `subject` in the folder `out`. Throws std::runtime_error with one line if
  /// the code is not 1 to 32 letters and digits.
  StudyFolder(const std::filesystem::path& out, const Study& study, const std::string& subject);

  [[nodiscard]] std::filesystem::path eventsFile() const { return motionPath("_events.tsv"); }
  [[nodiscard]] std::filesystem::path motionFile() const { return trackedPath("_motion.tsv"); }
  /// Returns the name of a file that does not exist, for the recording of this run.
  [[nodiscard]] std::filesystem::path nextRecording() const;

  /// Throws std::runtime_error with one line if the subject has begun the study.
  void requireNew() const;
  /// Creates the folders of a new subject. Throws std::runtime_error with one line.
  void create() const;
  /// Writes the files of the dataset and of a new subject. Throws std::runtime_error with one line.
  void begin(const NewSubject& subject);
  /// Returns the start of the recording of a subject that is continued. Throws std::runtime_error
  /// with one line if the subject has not begun, if the study file was another one, or if
  /// `is_simulated` differs.
  [[nodiscard]] WallTime resume(const std::string& study_text, bool is_simulated) const;
  /// Writes the duration of the recording.
  void finish(double duration_s);

 private:
  [[nodiscard]] std::filesystem::path motionPath(const std::string& ending) const;
  [[nodiscard]] std::filesystem::path trackedPath(const std::string& ending) const;
  [[nodiscard]] std::filesystem::path sourcePath(const std::string& ending) const;
  void describeDataset() const;
  void describeMotion(double duration_s) const;
  void describeEvents(const NewSubject& subject) const;

  std::filesystem::path out_;
  const Study& study_;
  std::string subject_;  // with sub-
  std::string device_;
};

}  // namespace hapticast::client
