// SPDX-License-Identifier: MIT
#include "client/study_run/study_checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <system_error>

#include "client/haptics/dynamic_force.hpp"
#include "client/settings/command_line.hpp"
#include "client/study/motion_file.hpp"
#include "common/playback/stream_reader.hpp"
#include "common/recording/progress_log.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

constexpr double kStiffnessShare = 3.0;  // as HapticRenderer: limit of an author's stiffness
constexpr double kMassTolerance = 0.01;  // chosen: less than any JND of mass
// Chosen: a subject answers within so long on average.
constexpr double kAnswer_s = 20.0;
// A tick in the recording of a run (measured: 330 bytes), and its share of pictures.
constexpr double kRecordedTick_bytes = 500.0;

/// What the checks need of a recording.
struct RecordingFacts {
  StreamDescription description;
  double stiffest_N_mm = 0.0;  // of all objects
};

RecordingFacts readFacts(const std::string& file, JsonPlace place, double usual_N_mm) {
  auto opened = StreamReader::open(file, logScan(file));
  if (!opened.ok())
    throw JsonError(place, fmt::format("the recording {} {}", quote(file), opened.error().message));
  StreamReader reader = std::move(opened).value();
  RecordingFacts facts{.description = reader.description(), .stiffest_N_mm = 0.0};
  while (const auto item = reader.next()) {
    const auto* const frame = std::get_if<CodedFrame>(&*item);
    if (frame == nullptr) continue;
    for (const CodedObject& object : frame->objects)
      facts.stiffest_N_mm =
          std::max(facts.stiffest_N_mm, object.material.stiffness_N_mm.value_or(usual_N_mm));
  }
  if (!reader.problem().empty())
    throw JsonError(place, fmt::format("the recording {} {}", quote(file), reader.problem()));
  return facts;
}

void requireStiffness(const Condition& condition, const RecordingFacts& facts, double limit_N_mm) {
  const double stiffest_N_mm = facts.stiffest_N_mm;
  const double wanted_N_mm = condition.stiffness * stiffest_N_mm;
  if (wanted_N_mm <= limit_N_mm * (1.0 + 1e-9)) return;
  throw JsonError(
      condition.place,
      fmt::format("{}: the device cannot render {:.3g} N/mm ({:g} times the {:.3g} N/mm of the "
                  "recording); its limit is {:.3g} N/mm (--stiffness-limit)",
                  quote(condition.name), wanted_N_mm, condition.stiffness, stiffest_N_mm,
                  limit_N_mm));
}

void requireMass(const Condition& condition, const RecordingFacts& facts,
                 const DeviceProfile& profile) {
  if (!condition.mass_kg) return;
  StreamTiming timing;
  timing.largest_acceleration_mm_s2 = facts.description.largest_acceleration_mm_s2;
  DynamicForce force(profile);
  force.replaceMass(condition.mass_kg);
  const double scale = DeviceMapping::fit(facts.description.workspace, profile.workspace_mm).scale;
  const double rendered_kg = force.objectMass_kg({}, timing, scale);
  if (std::abs(rendered_kg - *condition.mass_kg) <= kMassTolerance * *condition.mass_kg) return;
  throw JsonError(condition.place,
                  fmt::format("{}: the device renders {:.3g} kg in place of {:.3g} kg in this "
                              "recording",
                              quote(condition.name), rendered_kg, *condition.mass_kg));
}

void requireServer(const Condition& condition) {
  try {
    Settings settings;
    setServer(settings, condition.server);
  } catch (const std::exception& error) {
    throw JsonError(condition.place, error.what());
  }
}

/// Returns the condition with the largest level, or as it is. The smallest value is the reference.
Condition takeLargest(const Condition& condition, const std::optional<Comparison>& comparison) {
  if (!comparison) return condition;
  return withVariable(condition, comparison->variable,
                      comparison->reference + comparison->findLargestLevel());
}

}  // namespace

void requireRenderable(const Study& study, const DeviceProfile& profile,
                       double stiffness_limit_N_mm) {
  const double limit_N_mm =
      stiffness_limit_N_mm > 0.0 ? stiffness_limit_N_mm : kStiffnessShare * profile.stiffness_N_mm;
  std::map<std::string, RecordingFacts> known;
  for (const Condition& condition : study.conditions) {
    const Condition largest = takeLargest(condition, study.comparison);
    if (!condition.server.empty()) {
      requireServer(condition);
      if (largest.delay_ms > 0.0 || condition.jitter_ms > 0.0)
        throw JsonError(condition.place,
                        quote(condition.name) + ": a delay or a jitter needs a recording");
      continue;
    }
    if (!known.contains(condition.recording))
      known.emplace(condition.recording,
                    readFacts(condition.recording, condition.place, profile.stiffness_N_mm));
    const RecordingFacts& facts = known.at(condition.recording);
    requireStiffness(largest, facts, limit_N_mm);
    requireMass(largest, facts, profile);
    if (study.comparison && study.comparison->variable == Variable::kMass)
      requireMass(withVariable(condition, Variable::kMass, study.comparison->reference), facts,
                  profile);
  }
}

void requireSpace(const Study& study, const std::filesystem::path& out) {
  double longest_s = 0.0;
  for (const Condition& condition : study.conditions)
    longest_s = std::max(longest_s, condition.seconds);
  const double intervals = study.comparison ? 2.0 : 1.0;
  const double ticks =
      1e3 * static_cast<double>(study.countTrials()) * (intervals * longest_s + kAnswer_s);
  const double needed_bytes = ticks * (double{kMotionRow_bytes} + kRecordedTick_bytes);
  std::error_code error;
  std::filesystem::path there = std::filesystem::absolute(out);
  while (!std::filesystem::exists(there, error) && there.has_relative_path())
    there = there.parent_path();
  const std::filesystem::space_info space = std::filesystem::space(there, error);
  if (error || static_cast<double>(space.available) >= needed_bytes) return;
  throw std::runtime_error(
      fmt::format("--out {}: the study needs up to {:.1f} GB, and the disk has {:.1f} GB left",
                  out.string(), 1e-9 * needed_bytes, 1e-9 * static_cast<double>(space.available)));
}

}  // namespace hapticast::client
