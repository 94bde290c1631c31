// SPDX-License-Identifier: MIT
// Buttons of a device as answers of a study.
#include "client/view/study_prompt.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

StudyInput press(const StudyPrompt& prompt, std::initializer_list<int> buttons) {
  StudyInput input;
  for (const int button : buttons) enterButton(prompt, button, input);
  return input;
}

TEST(StudyPrompt, AButtonChoosesItsAnswer) {
  const StudyPrompt prompt{.text = "Which one?", .choices = {"first", "second"}};
  EXPECT_EQ(press(prompt, {1}).choice, 1U);
  EXPECT_EQ(press(prompt, {2, 31}).choice, std::nullopt) << "there is no third answer";
  EXPECT_FALSE(press(prompt, {2}).confirmed);
}

TEST(StudyPrompt, AnyButtonConfirmsAPromptWithoutAnswers) {
  const StudyPrompt prompt{.text = "Trial 1", .needs_enter = true};
  EXPECT_TRUE(press(prompt, {0}).confirmed);
  EXPECT_TRUE(press(prompt, {3}).confirmed);
}

TEST(StudyPrompt, TwoButtonsMoveTheSliderAndAnotherOneConfirms) {
  const StudyPrompt prompt{.text = "How stiff?", .is_scale = true, .needs_enter = true};
  EXPECT_EQ(press(prompt, {0, 0, 1}).scale, 45.0);
  EXPECT_FALSE(press(prompt, {0, 1}).confirmed);
  EXPECT_TRUE(press(prompt, {2}).confirmed);
  StudyInput input;
  for (int i = 0; i < 100; ++i) enterButton(prompt, 1, input);
  EXPECT_EQ(input.scale, 100.0);
}

}  // namespace
}  // namespace hapticast::client
