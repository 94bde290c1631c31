// SPDX-License-Identifier: MIT
#include "client/study/study_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "client/study/located_json.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostFile_bytes = std::size_t{1} << 20U;  // chosen
constexpr std::size_t kMostText_bytes = 4000;                   // chosen: a page
constexpr std::size_t kMostLabel_bytes = 64;
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

bool isPrintable(const std::string& text) {
  return std::none_of(text.begin(), text.end(),
                      [](unsigned char c) { return (c < 0x20 && c != '\n') || c == 0x7F; });
}

/// The members of one object. Each function reads one member, and throws LocatedError with its line
/// if the member is invalid.
class Members {
 public:
  Members(const Json& object, std::string path, const JsonLines& lines)
      : object_(object), path_(std::move(path)), lines_(lines) {
    if (!object.is_object()) throw LocatedError(line(), "is no JSON object {...}");
  }

  [[nodiscard]] int line() const { return find(path_); }
  [[nodiscard]] bool has(const char* key) const { return object_.contains(key); }
  [[noreturn]] void refuse(const char* key, const std::string& what) const {
    throw LocatedError(find(path_ + "/" + key), quote(key) + " " + what);
  }
  /// Returns the number `key`, or `otherwise` where it is missing.
  double number(const char* key, double least, double most, double otherwise) {
    const Json* const value = read(key);
    if (value == nullptr) return otherwise;
    const double number = value->is_number() ? value->get<double>() : std::nan("");
    if (number >= least && number <= most) return number;
    refuse(key, fmt::format("is no number from {:g} to {:g}", least, most));
  }
  std::size_t count(const char* key, std::size_t least, std::size_t most, std::size_t otherwise) {
    const double number = this->number(key, static_cast<double>(least), static_cast<double>(most),
                                       static_cast<double>(otherwise));
    if (number == std::floor(number)) return static_cast<std::size_t>(number);
    refuse(key, "is no whole number");
  }
  std::string text(const char* key, std::size_t most_bytes, std::string otherwise = {}) {
    const Json* const value = read(key);
    if (value == nullptr) return otherwise;
    if (value->is_string()) {
      auto text = value->get<std::string>();
      if (!text.empty() && text.size() <= most_bytes && isPrintable(text)) return text;
    }
    refuse(key, fmt::format("is no text of 1 to {} bytes", most_bytes));
  }
  template <class Value>
  Value choice(const char* key, const std::map<std::string, Value>& choices, Value otherwise) {
    const Json* const value = read(key);
    if (value == nullptr) return otherwise;
    const auto found = value->is_string() ? choices.find(value->get<std::string>()) : choices.end();
    if (found != choices.end()) return found->second;
    std::string names;
    for (const auto& [name, unused] : choices) names += (names.empty() ? "" : ", ") + name;
    refuse(key, "is none of " + names);
  }
  /// Returns the value of `key`, or null where it is missing.
  const Json* read(const char* key) {
    known_.insert(key);
    const auto value = object_.find(key);
    return value == object_.end() ? nullptr : &*value;
  }
  [[nodiscard]] Members object(const char* key) { return {*read(key), path_ + "/" + key, lines_}; }
  /// Refuses members that no function has read.
  void refuseOthers() const {
    for (const auto& [key, unused] : object_.items()) {
      if (known_.contains(key)) continue;
      refuse(key.c_str(),
             "is no member of a study here" + spellingHint(key, {known_.begin(), known_.end()}));
    }
  }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const JsonLines& lines() const { return lines_; }

 private:
  /// Returns the line of the member `path`, or of the nearest one around it.
  [[nodiscard]] int find(std::string path) const {
    while (true) {
      const auto found = lines_.find(path);
      if (found != lines_.end()) return found->second;
      if (path.empty()) return 1;
      path.resize(path.rfind('/'));
    }
  }

  const Json& object_;
  std::string path_;
  const JsonLines& lines_;
  std::set<std::string> known_;
};

std::optional<double> readOptional(Members& from, const char* key, double least, double most,
                                   const std::optional<double>& otherwise) {
  return from.has(key) ? from.number(key, least, most, 0.0) : otherwise;
}

void requireOneStream(const Members& from, const Condition& condition) {
  if (!condition.recording.empty() && !condition.server.empty())
    throw LocatedError(from.line(), "a condition has both a recording and a server");
}

Condition readCondition(Members from, const Condition& base) {
  Condition to = base;
  to.line = from.line();
  to.name = from.text("name", kMostLabel_bytes);
  if (to.name.find(':') != std::string::npos) from.refuse("name", "has a colon");
  if (from.has("recording")) to.server.clear();
  if (from.has("server")) to.recording.clear();
  to.recording = from.text("recording", kMostText_bytes, to.recording);
  to.server = from.text("server", kMostText_bytes, to.server);
  requireOneStream(from, to);
  to.seconds = from.number("seconds", 0.05, kMostSeconds, base.seconds);
  std::tie(to.static_on, to.dynamic_on) =
      from.choice("forces", kForces, {base.static_on, base.dynamic_on});
  to.stiffness = from.number("stiffness", 0.1, 3.0, base.stiffness);
  to.mass_kg = readOptional(from, "mass_kg", 0.001, 5.0, base.mass_kg);
  to.method = from.choice("method", kMethods, base.method);
  to.surface = from.choice("surface", kSurfaces, base.surface);
  to.delay_ms = from.number("delay_ms", 0.0, kMostDelay_ms, base.delay_ms);
  to.jitter_ms = from.number("jitter_ms", 0.0, kMostDelay_ms, base.jitter_ms);
  to.pause_at_s = readOptional(from, "pause_at_s", 0.0, kMostSeconds, base.pause_at_s);
  if (to.pause_at_s && *to.pause_at_s >= to.seconds)
    from.refuse("pause_at_s", "is not before the end of the interval (\"seconds\")");
  if (to.method == Method::kThesis && from.has("surface") && to.surface != SurfaceKind::kPerturbed)
    from.refuse("surface", "cannot be rendered: the thesis's method has the surface perturbed");
  if (to.method == Method::kThesis) to.surface = SurfaceKind::kPerturbed;
  from.refuseOthers();
  return to;
}

Question readQuestion(Members from) {
  Question to;
  to.kind = from.choice("kind", kQuestions, QuestionKind::kLikert);
  to.text = from.text("text", kMostText_bytes);
  if (to.text.empty()) throw LocatedError(from.line(), "\"question\" has no \"text\"");
  if (to.kind != QuestionKind::kForcedChoice) {
    to.low = from.text("low", kMostLabel_bytes);
    to.high = from.text("high", kMostLabel_bytes);
  }
  if (to.kind == QuestionKind::kLikert) to.steps = from.count("steps", 2, 9, to.steps);
  from.refuseOthers();
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

std::vector<double> readLevels(Members& from) {
  const Json* const list = from.read("levels");
  std::vector<double> levels;
  if (list != nullptr && list->is_array() && list->size() <= 100) {
    for (const Json& each : *list) levels.push_back(each.is_number() ? each.get<double>() : 0.0);
  }
  const bool valid = !levels.empty() && std::all_of(levels.begin(), levels.end(), [](double level) {
    return level > 0.0 && std::isfinite(level);
  });
  if (!valid) from.refuse("levels", "is no list of 1 to 100 numbers above 0");
  return levels;
}

void readStaircase(Members& from, Comparison& to) {
  to.start = from.number("start", to.range.least, to.range.most, to.range.most);
  to.up = static_cast<int>(from.count("up", 1, 9, 1));
  to.down = static_cast<int>(from.count("down", 1, 9, 3));
  to.factor = from.number("factor", 1.01, 10.0, to.factor);
}

Comparison readComparison(Members from) {
  Comparison to;
  to.variable = from.choice("variable", kVariables, to.variable);
  const double most = findLargest(to.variable);
  const double least = findLeast(to.variable);
  to.reference = from.number("reference", least, most, least);
  to.selector = from.choice("selection", kSelectors, to.selector);
  if (to.selector == SelectorKind::kConstantStimuli) {
    to.levels = readLevels(from);
    // Chosen: a threshold beyond the levels by more than a factor of 2 is not measured.
    to.range.least = 0.5 * *std::min_element(to.levels.begin(), to.levels.end());
    to.range.most = 2.0 * *std::max_element(to.levels.begin(), to.levels.end());
  } else {
    to.range.most = from.number("most", 1e-6, most, most - to.reference);
    to.range.least = from.number("least", 1e-6, most, 0.01 * to.range.most);
    if (!(to.range.least < to.range.most)) from.refuse("least", "is not below \"most\"");
  }
  if (to.selector == SelectorKind::kStaircase) readStaircase(from, to);
  to.lapse = from.number("lapse", 0.0, 0.2, to.lapse);
  const double largest = to.findLargestLevel();
  if (to.reference + largest > most)
    throw LocatedError(from.line(), fmt::format("the reference and the largest level are {:g}; the "
                                                "client renders at most {:g}",
                                                to.reference + largest, most));
  from.refuseOthers();
  return to;
}

void readConditions(Members& from, Study& study) {
  Condition base;
  if (from.has("defaults")) base = readCondition(from.object("defaults"), base);
  base.name.clear();
  const Json* const list = from.read("conditions");
  if (list == nullptr || !list->is_array() || list->empty() || list->size() > 100)
    from.refuse("conditions", "is no list of 1 to 100 conditions");
  std::set<std::string> names;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string path = fmt::format("/conditions/{}", i);
    study.conditions.push_back(readCondition({(*list)[i], path, from.lines()}, base));
    const Condition& condition = study.conditions.back();
    if (condition.name.empty()) throw LocatedError(condition.line, "a condition has no \"name\"");
    if (!names.insert(condition.name).second)
      throw LocatedError(condition.line, "two conditions have the name " + quote(condition.name));
    if (condition.recording.empty() && condition.server.empty())
      throw LocatedError(condition.line,
                         quote(condition.name) + " has neither \"recording\" nor \"server\"");
  }
}

void requireConsistent(const Study& study, Members& from) {
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
  JsonLines lines;
  const Json json = parseLocated(text, lines);
  Members from(json, "", lines);
  Study study;
  study.name = from.text("name", kMostLabel_bytes);
  if (!isLabel(study.name)) from.refuse("name", "is no text of letters and digits");
  study.consent = from.text("consent", kMostText_bytes);
  if (study.consent.empty()) from.refuse("consent", "is missing: the text for the subject");
  study.seed = from.count("seed", 0, std::size_t{1} << 52U, 0);
  study.order = from.choice("order", kOrders, study.order);
  study.blocks = from.count("blocks", 1, kMostTrials, 1);
  study.training = from.count("training", 0, kMostTrials, 0);
  study.rest_every = from.count("rest_every", 0, kMostTrials, 0);
  if (!from.has("question")) from.refuse("question", "is missing");
  study.question = readQuestion(from.object("question"));
  if (from.has("comparison")) study.comparison = readComparison(from.object("comparison"));
  readConditions(from, study);
  requireConsistent(study, from);
  from.refuseOthers();
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
