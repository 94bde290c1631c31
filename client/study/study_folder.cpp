// SPDX-License-Identifier: MIT
#include "client/study/study_folder.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "client/study/events_file.hpp"
#include "client/study/motion_file.hpp"
#include "common/cli/run_program.hpp"
#include "common/write_file.hpp"

namespace hapticast::client {

namespace {

using OrderedJson = nlohmann::ordered_json;
namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

void writeText(const fs::path& file, const std::string& text) {
  const std::span bytes(reinterpret_cast<const unsigned char*>(text.data()), text.size());
  if (const auto error = writeFile(file.string(), bytes)) refuse(file, error->message);
}

void writeJson(const fs::path& file, const OrderedJson& json) {
  writeText(file, json.dump(2) + "\n");
}

std::string readText(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string firstField(const std::string& row) { return row.substr(0, row.find('\t')); }

/// Adds `row` to a table that begins with `header`, in place of a row with the same first field.
/// Other columns of the table get "n/a". An interruption keeps the table as it was.
void addRow(const fs::path& file, const std::string& header, std::string row) {
  std::istringstream in(readText(file));
  std::string table;
  std::string line;
  std::getline(in, line);
  const std::string first = line.empty() ? header : line;
  const auto columns = std::count(first.begin(), first.end(), '\t');
  for (auto i = std::count(row.begin(), row.end(), '\t'); i < columns; ++i) row += "\tn/a";
  table = first + "\n";
  while (std::getline(in, line))
    if (!line.empty() && firstField(line) != firstField(row)) table += line + "\n";
  const fs::path next = file.string() + ".new";
  writeText(next, table + row + "\n");
  std::error_code error;
  fs::rename(next, file, error);
  if (error) refuse(file, "cannot be written (" + error.message() + ")");
}

void createFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse(folder, "cannot be created (" + error.message() + ")");
}

const char* toText(Method method) { return method == Method::kThesis ? "thesis" : "hapticast"; }

const char* toText(SurfaceKind surface) {
  return surface == SurfaceKind::kProxy    ? "proxy"
         : surface == SurfaceKind::kNormal ? "normal"
                                           : "perturbed";
}

/// Returns the settings of a condition as one line.
std::string describe(const Condition& condition) {
  std::string text = fmt::format(
      "{}: {}, {:g} s, static force {}, dynamic force {}, stiffness {:g}, method {}, surface {}",
      condition.name, condition.server.empty() ? condition.recording : condition.server,
      condition.seconds, condition.static_on ? "on" : "off", condition.dynamic_on ? "on" : "off",
      condition.stiffness, toText(condition.method), toText(condition.surface));
  if (condition.mass_kg) text += fmt::format(", mass {:g} kg", *condition.mass_kg);
  if (condition.delay_ms > 0.0) text += fmt::format(", delay {:g} ms", condition.delay_ms);
  if (condition.jitter_ms > 0.0) text += fmt::format(", jitter {:g} ms", condition.jitter_ms);
  if (condition.pause_at_s) text += fmt::format(", paused at {:g} s", *condition.pause_at_s);
  return text;
}

const char* describeUnit(const Study& study) {
  if (!study.comparison) return "n/a";
  switch (study.comparison->variable) {
    case Variable::kMass:
      return "kg";
    case Variable::kDelay:
      return "ms";
    case Variable::kStiffness:
      break;
  }
  return "1";
}

constexpr const char* kSimulated = ". A simulated observer answered.";
constexpr const char* kReadme =
    "Results of a study with hapticast-client --study. Each subject has a code and no other\n"
    "personal data. sourcedata/ has the study file and the recordings (MCAP) of each run.\n";

WallTime parseIso8601(const std::string& text) {
  std::tm parts{};
  std::istringstream in(text);
  in >> std::get_time(&parts, "%Y-%m-%dT%H:%M:%S");
  double fraction_s = 0.0;
  in >> fraction_s;
  return std::chrono::system_clock::from_time_t(::timegm(&parts)) +
         std::chrono::duration_cast<WallTime::duration>(std::chrono::duration<double>(fraction_s));
}

}  // namespace

std::string formatIso8601(WallTime time) {
  const auto since = time.time_since_epoch();
  const std::time_t seconds =
      std::chrono::system_clock::to_time_t(std::chrono::floor<std::chrono::seconds>(time));
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(since).count() % 1'000'000;
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  return fmt::format("{}.{:06}Z", std::string_view(text.data(), size), us);
}

StudyFolder::StudyFolder(const fs::path& out, const Study& study, const std::string& subject)
    : out_(out), study_(study), subject_("sub-" + subject) {
  if (subject.size() > 32 || !isLabel(subject))
    throw std::runtime_error("--subject " + subject +
                             ": is no code of 1 to 32 letters and digits; use no name");
}

void StudyFolder::requireNew() const {
  if (fs::exists(eventsFile()))
    refuse(eventsFile(), "this subject has begun the study; continue with --resume");
}

void StudyFolder::create() const {
  createFolder(out_ / subject_ / "motion");
  createFolder(out_ / "sourcedata" / subject_);
}

fs::path StudyFolder::motionPath(const std::string& ending) const {
  return out_ / subject_ / "motion" / (subject_ + "_task-" + study_.name + ending);
}

fs::path StudyFolder::trackedPath(const std::string& ending) const {
  return motionPath("_tracksys-haptic" + ending);
}

fs::path StudyFolder::sourcePath(const std::string& ending) const {
  return out_ / "sourcedata" / subject_ / (subject_ + "_task-" + study_.name + ending);
}

fs::path StudyFolder::nextRecording() const {
  for (int run = 1;; ++run) {
    fs::path file = sourcePath(fmt::format("_run-{}.mcap", run));
    if (!fs::exists(file)) return file;
  }
}

void StudyFolder::begin(const NewSubject& subject) {
  device_ = subject.device;
  describeDataset();
  writeText(sourcePath("_study.json"), subject.study_text);
  std::string channels =
      "name\tcomponent\ttype\ttracked_point\tunits\treference_frame\tdescription\n";
  for (const MotionChannel& each : kMotionChannels)
    channels += fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}\n", each.name, each.component, each.type,
                            each.point, each.units,
                            std::string_view(each.component) == "n/a" ? "n/a" : "picture",
                            each.description);
  writeText(trackedPath("_channels.tsv"), channels);
  OrderedJson frames;
  frames["reference_frame"]["Levels"]["picture"] = {
      {"SpatialAxes", "RSP"},
      {"Description", "x right, y up, z out of the screen towards the viewer"}};
  writeJson(trackedPath("_channels.json"), frames);
  describeMotion(0.0);
  describeEvents(subject);
  const std::string participants = readText(out_ / "participants.tsv");
  if (("\n" + participants).find("\n" + subject_ + "\n") == std::string::npos &&
      participants.find("\n" + subject_ + "\t") ==
          std::string::npos)  // a lab may have added columns
    addRow(out_ / "participants.tsv", "participant_id", subject_);
  addRow(
      out_ / subject_ / (subject_ + "_scans.tsv"), "filename\tacq_time",
      fmt::format("motion/{}\t{}", motionFile().filename().string(), formatIso8601(subject.start)));
}

void StudyFolder::describeDataset() const {
  const fs::path file = out_ / "dataset_description.json";
  if (fs::exists(file)) return;
  writeJson(file, {{"Name", "Studies with hapticast"},
                   {"BIDSVersion", "1.9.0"},
                   {"DatasetType", "raw"},
                   {"GeneratedBy", OrderedJson::array({{{"Name", "hapticast-client"},
                                                        {"Version", programVersion()}}})}});
  writeText(out_ / "README", kReadme);
}

void StudyFolder::describeMotion(double duration_s) const {
  const auto count = [](std::string_view type) {
    return std::count_if(kMotionChannels.begin(), kMotionChannels.end(),
                         [type](const MotionChannel& each) { return each.type == type; });
  };
  OrderedJson motion{{"TaskName", study_.name},
                     {"TaskDescription", study_.question.text},
                     {"SamplingFrequency", 1000},
                     {"TrackingSystemName", "haptic"},
                     {"Manufacturer", "n/a"},
                     {"ManufacturersModelName", device_.empty() ? "n/a" : device_},
                     {"SoftwareVersions", std::string("hapticast ") + programVersion()},
                     {"RecordingType", "discontinuous"},
                     {"MotionChannelCount", kMotionChannels.size()},
                     {"POSChannelCount", count("POS")},
                     {"LATENCYChannelCount", count("LATENCY")},
                     {"MISCChannelCount", count("MISC")},
                     {"TrackedPointsCount", 1}};
  if (duration_s > 0.0) motion["RecordingDuration"] = duration_s;
  writeJson(trackedPath("_motion.json"), motion);
}

void StudyFolder::describeEvents(const NewSubject& subject) const {
  OrderedJson events;
  for (const EventColumn& column : listEventColumns())
    events[column.name]["Description"] = column.description;
  for (const char* seconds : {"onset", "duration", "response_time"}) events[seconds]["Units"] = "s";
  events["level"]["Units"] = describeUnit(study_);
  if (subject.is_simulated)
    events["answer"]["Description"] =
        events["answer"]["Description"].get<std::string>() + kSimulated;
  for (std::size_t i = 0; i < subject.codes.size(); ++i)
    events["condition"]["Levels"][subject.codes[i]] = describe(study_.conditions[i]);
  if (study_.comparison) events["level"]["Reference"] = study_.comparison->reference;
  writeJson(motionPath("_events.json"), events);
}

WallTime StudyFolder::resume(const std::string& study_text, bool is_simulated) const {
  if (!fs::exists(eventsFile()))
    refuse(eventsFile(), "this subject has not begun the study; start without --resume");
  if (readText(sourcePath("_study.json")) != study_text)
    refuse(sourcePath("_study.json"),
           "this subject began with another study file; continue with that one");
  const bool was_simulated =
      readText(motionPath("_events.json")).find(kSimulated) != std::string::npos;
  if (was_simulated != is_simulated)
    refuse(eventsFile(), was_simulated ? "an observer began; continue with --simulate"
                                       : "a person began; continue without --simulate");
  const std::string table = readText(out_ / subject_ / (subject_ + "_scans.tsv"));
  const std::string key = "motion/" + motionFile().filename().string() + "\t";
  const std::size_t row = table.find("\n" + key);
  if (row == std::string::npos)
    refuse(out_ / subject_ / (subject_ + "_scans.tsv"), "has no row of the motion file");
  return parseIso8601(table.substr(row + 1 + key.size(), 27));
}

void StudyFolder::finish(double duration_s) {
  const fs::path file = trackedPath("_motion.json");
  OrderedJson motion = OrderedJson::parse(readText(file), nullptr, false);
  if (!motion.is_object()) return describeMotion(duration_s);
  motion["RecordingDuration"] = duration_s;
  writeJson(file, motion);
}

}  // namespace hapticast::client
