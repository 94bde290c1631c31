// SPDX-License-Identifier: MIT
// Study files: what they state, and the line of what is wrong.
#include "client/study/study_file.hpp"

#include <gtest/gtest.h>

#include <string>

#include "common/json/json_error.hpp"

namespace hapticast::client {
namespace {

const std::string kRating = R"({
  "name": "ball",
  "consent": "You touch a ball.",
  "seed": 3,
  "order": "latin square",
  "blocks": 2,
  "question": {"kind": "likert", "text": "How real?", "steps": 5, "low": "not", "high": "very"},
  "defaults": {"recording": "ball.mcap", "seconds": 4},
  "conditions": [
    {"name": "static", "forces": "static", "pause_at_s": 2},
    {
      "name": "thesis", "method": "thesis", "mass_kg": 0.6
    }
  ]
})";

const std::string kChoice = R"({
  "name": "jnd",
  "consent": "You press.",
  "question": {"kind": "2afc", "text": "Which one was stiffer?"},
  "comparison": {"variable": "stiffness", "reference": 1, "selection": "staircase",
                 "least": 0.02, "most": 1, "start": 0.5, "up": 1, "down": 2, "factor": 1.3},
  "conditions": [{"name": "still", "recording": "ball.mcap", "jitter_ms": 80}]
})";

/// Replaces the only `from` in `text`.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

void expectRefused(const std::string& text, int line, const std::string& what) {
  try {
    (void)parseStudy(text);
    ADD_FAILURE() << "accepted: " << what;
  } catch (const JsonError& error) {
    EXPECT_EQ(error.place.line, line) << error.what();
    EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
  }
}

TEST(StudyFile, StatesConditionsQuestionAndOrder) {
  const Study study = parseStudy(kRating);
  EXPECT_EQ(study.name, "ball");
  EXPECT_EQ(study.seed, 3U);
  EXPECT_EQ(study.order, TrialOrder::kLatinSquare);
  EXPECT_EQ(study.countTrials(), 4U);
  EXPECT_EQ(study.question.steps, 5U);
  ASSERT_EQ(study.conditions.size(), 2U);
  EXPECT_FALSE(study.conditions[0].dynamic_on);
  EXPECT_EQ(study.conditions[0].pause_at_s, 2.0);
  EXPECT_EQ(study.conditions[0].seconds, 4.0);
  EXPECT_EQ(study.conditions[0].place.line, 10);
  EXPECT_EQ(study.conditions[1].method, Method::kThesis);
  EXPECT_EQ(study.conditions[1].surface, SurfaceKind::kPerturbed);
  EXPECT_EQ(study.conditions[1].mass_kg, 0.6);
  EXPECT_EQ(study.conditions[1].place.line, 11);
}

TEST(StudyFile, StatesAForcedChoice) {
  const Study study = parseStudy(kChoice);
  ASSERT_TRUE(study.comparison);
  EXPECT_EQ(study.comparison->selector, SelectorKind::kStaircase);
  EXPECT_EQ(study.comparison->down, 2);
  EXPECT_EQ(study.comparison->start, 0.5);
  EXPECT_EQ(study.conditions[0].jitter_ms, 80.0);
}

TEST(StudyFile, RefusesWithTheLineOfTheMistake) {
  expectRefused("", 1, "is no JSON");
  expectRefused("[]", 1, "is no JSON object");
  expectRefused(replaced(kRating, "\"seed\": 3,", "\"seed\": 3"), 5, "is no JSON");
  expectRefused(replaced(kRating, "\"ball\"", "\"my ball\""), 2, "letters and digits");
  expectRefused(replaced(kRating, "  \"consent\": \"You touch a ball.\",\n", ""), 1, "consent");
  expectRefused(replaced(kRating, "\"seed\"", "\"sead\""), 4, "seed");
  expectRefused(replaced(kRating, "\"blocks\": 2", "\"blocks\": 5000"), 6, "10000 trials");
  expectRefused(replaced(kRating, "\"blocks\": 2", "\"seed\": 2"), 6, "appears twice");
  expectRefused(replaced(kRating, "\"steps\": 5", "\"steps\": 2.5"), 7, "whole number");
  expectRefused(replaced(kRating, "\"thesis\", \"method", "\"static\", \"method"), 11,
                "two conditions have the name 'static'");
  expectRefused(replaced(kRating, "\"pause_at_s\": 2", "\"pause_at_s\": 4"), 10,
                "not before the end");
  expectRefused(replaced(kRating, "\"mass_kg\": 0.6", "\"surface\": \"proxy\""), 12, "thesis");
  expectRefused(replaced(kRating, "\"mass_kg\": 0.6", "\"mass_kg\": 600"), 12, "0.001 to 5");
  expectRefused(replaced(kRating, "\"recording\": \"ball.mcap\", ", ""), 10, "neither");
  expectRefused(replaced(kRating, "\"forces\": \"static\"", "\"forces\": \"some\""), 10,
                "both, dynamic, none, static");
  expectRefused(replaced(kRating, "\"likert\"", "\"2afc\""), 7, "");
  expectRefused(replaced(kChoice, "\"most\": 1,", "\"most\": 2.5,"), 5, "at most 3");
  expectRefused(replaced(kChoice, "\"least\": 0.02", "\"least\": 1.5"), 6, "not below");
  expectRefused(replaced(kChoice, "\"2afc\"", "\"vas\""), 5, "2afc");
}

TEST(StudyFile, RefusesDeepAndLongFiles) {
  expectRefused("{\"a\":" + std::string(2000, '['), 1, "8 levels");
  EXPECT_THROW((void)readStudyText("/nowhere/study.json"), std::runtime_error);
}

}  // namespace
}  // namespace hapticast::client
