// SPDX-License-Identifier: MIT
#include "client/study/study_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "common/json/json_document.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

constexpr std::size_t kMostFile_bytes = std::size_t{1} << 20U;  // chosen
constexpr std::size_t kMostText_bytes = 4000;                   // chosen: a page
constexpr std::size_t kMostLabel_bytes = 64;
constexpr const char* kStranger = "is no member of a study here";
constexpr double kMostSeconds = 3600.0;
constexpr double kMostDelay_ms = 500.0;  // the window keeps pictures for longer

const std::map<std::string, TrialOrder> kOrders{{"random", TrialOrder::kRandomInBlocks},
                                                {"latin square", TrialOrder::kLatinSquare}};
const std::map<std::string, QuestionKind> kQuestions{{"likert", QuestionKind::kLikert},
                                                     {"vas", QuestionKind::kVisualAnalogue},
                                                     {"2afc", QuestionKind::kForcedChoice}};
const std::map<std::string, Variable> kVariables{
    {"stiffness", Variable::kStiffness}, {"mass", Variable::kMass}, {"delay", Variable::kDelay}};
const std::map<std::string, SelectorKind> kSelectors{
    {"constant stimuli", SelectorKind::kConstantStimuli},
    {"staircase", SelectorKind::kStaircase},
    {"quest", SelectorKind::kQuest}};
using ForcePair = std::pair<bool, bool>;  // static, dynamic
const std::map<std::string, ForcePair> kForces{{"both", {true, true}},
                                               {"static", {true, false}},
                                               {"dynamic", {false, true}},
                                               {"none", {false, false}}};
const std::map<std::string, Method> kMethods{{"hapticast", Method::kHapticast},
                                             {"thesis", Method::kThesis}};
const std::map<std::string, SurfaceKind> kSurfaces{{"proxy", SurfaceKind::kProxy},
                                                   {"normal", SurfaceKind::kNormal},
                                                   {"perturbed", SurfaceKind::kPerturbed}};

std::optional<double> readOptional(JsonObject& from, const char* key, double least, double most,
                                   const std::optional<double>& otherwise) {
  const auto number = from.number(key, least, most);
  return number ? number : otherwise;
}

void requireOneStream(const JsonObject& from, const Condition& condition) {
  if (!condition.recording.empty() && !condition.server.empty())
    throw JsonError(from.place(), "a condition has both a recording and a server");
}

Condition readCondition(JsonObject from, const Condition& base) {
  Condition to = base;
  to.place = from.place();
  to.name = from.text("name", kMostLabel_bytes).value_or("");
  if (to.name.find(':') != std::string::npos) from.refuse("name", "has a colon");
  if (from.has("recording")) to.server.clear();
  if (from.has("server")) to.recording.clear();
  to.recording = from.text("recording", kMostText_bytes).value_or(to.recording);
  to.server = from.text("server", kMostText_bytes).value_or(to.server);
  requireOneStream(from, to);
  to.seconds = from.number("seconds", 0.05, kMostSeconds).value_or(base.seconds);
  std::tie(to.static_on, to.dynamic_on) =
      from.choice("forces", kForces).value_or(ForcePair{base.static_on, base.dynamic_on});
  to.stiffness = from.number("stiffness", 0.1, 3.0).value_or(base.stiffness);
  to.mass_kg = readOptional(from, "mass_kg", 0.001, 5.0, base.mass_kg);
  to.method = from.choice("method", kMethods).value_or(base.method);
  to.surface = from.choice("surface", kSurfaces).value_or(base.surface);
  to.delay_ms = from.number("delay_ms", 0.0, kMostDelay_ms).value_or(base.delay_ms);
  to.jitter_ms = from.number("jitter_ms", 0.0, kMostDelay_ms).value_or(base.jitter_ms);
  to.pause_at_s = readOptional(from, "pause_at_s", 0.0, kMostSeconds, base.pause_at_s);
  if (to.pause_at_s && *to.pause_at_s >= to.seconds)
    from.refuse("pause_at_s", "is not before the end of the interval (\"seconds\")");
  if (to.method == Method::kThesis && from.has("surface") && to.surface != SurfaceKind::kPerturbed)
    from.refuse("surface", "cannot be rendered: the thesis's method has the surface perturbed");
  if (to.method == Method::kThesis) to.surface = SurfaceKind::kPerturbed;
  from.refuseOthers(kStranger);
  return to;
}

Question readQuestion(JsonObject from) {
  Question to;
  to.kind = from.choice("kind", kQuestions).value_or(QuestionKind::kLikert);
  to.text = from.text("text", kMostText_bytes).value_or("");
  if (to.text.empty()) throw JsonError(from.place(), "\"question\" has no \"text\"");
  if (to.kind != QuestionKind::kForcedChoice) {
    to.low = from.text("low", kMostLabel_bytes).value_or("");
    to.high = from.text("high", kMostLabel_bytes).value_or("");
  }
  if (to.kind == QuestionKind::kLikert) to.steps = from.count("steps", 2, 9).value_or(to.steps);
  from.refuseOthers(kStranger);
  return to;
}

/// Returns the largest value of a variable that the client renders.
double findLargest(Variable variable) {
  return variable == Variable::kStiffness ? 3.0 : variable == Variable::kMass ? 5.0 : kMostDelay_ms;
}

/// Returns the smallest one. A mass of 0 stands for an unknown mass, so it is none.
double findLeast(Variable variable) {
  return variable == Variable::kStiffness ? 0.1 : variable == Variable::kMass ? 0.001 : 0.0;
}

std::vector<double> readLevels(JsonObject& from) {
  const auto* const list = from.read("levels");
  std::vector<double> levels;
  if (list != nullptr && list->is_array() && list->size() <= 100) {
    for (const auto& each : *list) levels.push_back(each.is_number() ? each.get<double>() : 0.0);
  }
  const bool valid = !levels.empty() && std::all_of(levels.begin(), levels.end(), [](double level) {
    return level > 0.0 && std::isfinite(level);
  });
  if (!valid) from.refuse("levels", "is no list of 1 to 100 numbers above 0");
  return levels;
}

void readStaircase(JsonObject& from, Comparison& to) {
  to.start = from.number("start", to.range.least, to.range.most).value_or(to.range.most);
  to.up = static_cast<int>(from.count("up", 1, 9).value_or(1));
  to.down = static_cast<int>(from.count("down", 1, 9).value_or(3));
  to.factor = from.number("factor", 1.01, 10.0).value_or(to.factor);
}

Comparison readComparison(JsonObject from) {
  Comparison to;
  to.variable = from.choice("variable", kVariables).value_or(to.variable);
  const double most = findLargest(to.variable);
  const double least = findLeast(to.variable);
  to.reference = from.number("reference", least, most).value_or(least);
  to.selector = from.choice("selection", kSelectors).value_or(to.selector);
  if (to.selector == SelectorKind::kConstantStimuli) {
    to.levels = readLevels(from);
    // Chosen: a threshold beyond the levels by more than a factor of 2 is not measured.
    to.range.least = 0.5 * *std::min_element(to.levels.begin(), to.levels.end());
    to.range.most = 2.0 * *std::max_element(to.levels.begin(), to.levels.end());
  } else {
    to.range.most = from.number("most", 1e-6, most).value_or(most - to.reference);
    to.range.least = from.number("least", 1e-6, most).value_or(0.01 * to.range.most);
    if (!(to.range.least < to.range.most)) from.refuse("least", "is not below \"most\"");
  }
  if (to.selector == SelectorKind::kStaircase) readStaircase(from, to);
  to.lapse = from.number("lapse", 0.0, 0.2).value_or(to.lapse);
  const double largest = to.findLargestLevel();
  if (to.reference + largest > most)
    throw JsonError(from.place(), fmt::format("the reference and the largest level are {:g}; the "
                                              "client renders at most {:g}",
                                              to.reference + largest, most));
  from.refuseOthers(kStranger);
  return to;
}

void readConditions(JsonObject& from, Study& study) {
  Condition base;
  if (from.has("defaults")) base = readCondition(from.object("defaults"), base);
  base.name.clear();
  std::vector<JsonObject> list = from.objects("conditions", 100);
  if (list.empty()) from.refuse("conditions", "is no list of 1 to 100 conditions");
  std::set<std::string> names;
  for (JsonObject& each : list) {
    study.conditions.push_back(readCondition(std::move(each), base));
    const Condition& condition = study.conditions.back();
    if (condition.name.empty()) throw JsonError(condition.place, "a condition has no \"name\"");
    if (!names.insert(condition.name).second)
      throw JsonError(condition.place, "two conditions have the name " + quote(condition.name));
    if (condition.recording.empty() && condition.server.empty())
      throw JsonError(condition.place,
                      quote(condition.name) + " has neither \"recording\" nor \"server\"");
  }
}

void requireConsistent(const Study& study, JsonObject& from) {
  const bool is_choice = study.question.kind == QuestionKind::kForcedChoice;
  if (is_choice && !study.comparison)
    from.refuse("question", "of the kind 2afc needs a \"comparison\"");
  if (!is_choice && study.comparison)
    from.refuse("comparison", "needs a question of the kind 2afc");
  if (study.countTrials() > kMostTrials)
    from.refuse("blocks", fmt::format("times the conditions, plus the training, are {} trials; at "
                                      "most {} are possible",
                                      study.countTrials(), kMostTrials));
}

}  // namespace

Study parseStudy(std::string_view text) {
  const JsonDocument document = parseJson(text);
  JsonObject from(document);
  Study study;
  study.name = from.text("name", kMostLabel_bytes).value_or("");
  if (!isLabel(study.name)) from.refuse("name", "is no text of letters and digits");
  study.consent = from.text("consent", kMostText_bytes).value_or("");
  if (study.consent.empty()) from.refuse("consent", "is missing: the text for the subject");
  study.seed = from.count("seed", 0, std::size_t{1} << 52U).value_or(0);
  study.order = from.choice("order", kOrders).value_or(study.order);
  study.blocks = from.count("blocks", 1, kMostTrials).value_or(1);
  study.training = from.count("training", 0, kMostTrials).value_or(0);
  study.rest_every = from.count("rest_every", 0, kMostTrials).value_or(0);
  if (!from.has("question")) from.refuse("question", "is missing");
  study.question = readQuestion(from.object("question"));
  if (from.has("comparison")) study.comparison = readComparison(from.object("comparison"));
  readConditions(from, study);
  requireConsistent(study, from);
  from.refuseOthers(kStranger);
  return study;
}

std::string readStudyText(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (in.peek() != std::ifstream::traits_type::eof()) text << in.rdbuf();
  if (!in || text.str().empty())
    throw std::runtime_error("--study " + file + ": cannot be read, or is empty");
  if (text.str().size() > kMostFile_bytes)
    throw std::runtime_error("--study " + file + ": is larger than 1 MB, so it is no study");
  return text.str();
}

}  // namespace hapticast::client
