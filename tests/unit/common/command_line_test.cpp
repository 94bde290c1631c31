// SPDX-License-Identifier: MIT
#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/temp_folder.hpp"

namespace hapticast {
namespace {

TEST(CommandLine, PairIsTwoFiniteNumbers) {
  EXPECT_EQ(parsePair("505,330"), Vec2(505.0, 330.0));
  EXPECT_EQ(parsePair("-1.5,2e1"), Vec2(-1.5, 20.0));
  for (const char* text : {"", ",", "1", "1,", ",2", "1,2,3", "1,x", "nan,1", "inf,1", "1, 2"}) {
    EXPECT_FALSE(parsePair(text)) << text;
  }
}

class CommandLineTest : public testing::Test {
 protected:
  CommandLineTest() : app_("test", "program") {
    addList(app_, "--object", points_, parsePair, "points", "U,V in px");
    addEndpoint(app_, "--listen", listen_, 0, "HOST:PORT", "where");
    addNumber(app_, "--fps", fps_, 1.0, 240.0, "1..240", "rate");
    addNumber(app_, "--frames", frames_, std::uint64_t{1}, std::uint64_t{1000}, "N", "how many");
    addNumber(app_, "--mass", mass_kg_, 0.001, 100.0, "KG", "optional");
    app_.add_flag("--loop", loop_, "again");
    addChoice(app_, "--colour", colour_, colours_, "which");
    addConfigFile(app_);
  }

  std::optional<int> parse(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "program");
    return parseCommandLine(app_, static_cast<int>(arguments.size()), arguments.data());
  }

  const TempFolder folder_;
  CLI::App app_;
  std::vector<Vec2> points_;
  Endpoint listen_;
  double fps_ = 25.0;
  std::uint64_t frames_ = 0;
  std::optional<double> mass_kg_;
  bool loop_ = false;
  const std::map<std::string, int> colours_{{"green", 1}, {"blue", 2}};
  int colour_ = 0;
};

TEST_F(CommandLineTest, PointsRepeat) {
  EXPECT_EQ(parse({"--object", "1,2", "--object", "3,4"}), std::nullopt);
  EXPECT_EQ(points_, (std::vector<Vec2>{{1.0, 2.0}, {3.0, 4.0}}));
}

TEST_F(CommandLineTest, WrongValueIsOneLineWithFlagValueAndForm) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(parse({"--object", "12"}), 2);
  const std::string line = testing::internal::GetCapturedStderr();
  EXPECT_NE(line.find("--object"), std::string::npos) << line;
  EXPECT_NE(line.find("'12'"), std::string::npos) << line;
  EXPECT_NE(line.find("U,V in px"), std::string::npos) << line;
  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;

  testing::internal::CaptureStderr();
  EXPECT_EQ(parse({"--fps", "900"}), 2);
  const std::string range = testing::internal::GetCapturedStderr();
  EXPECT_NE(range.find("--fps"), std::string::npos) << range;
  EXPECT_NE(range.find("900"), std::string::npos) << range;
  EXPECT_NE(range.find("240"), std::string::npos) << range;
}

TEST_F(CommandLineTest, NumbersAreWholeTextsWithinTheirRange) {
  EXPECT_EQ(parse({"--fps", "2.5e1", "--frames", "1000", "--mass", "0.5"}), std::nullopt);
  EXPECT_DOUBLE_EQ(fps_, 25.0);
  EXPECT_EQ(frames_, 1000U);
  EXPECT_EQ(mass_kg_, 0.5);
  for (const char* wrong : {"", "nan", "inf", "0", "241", "25x", "1e999", "true"}) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(parse({"--fps", wrong}), 2) << wrong;
    EXPECT_NE(testing::internal::GetCapturedStderr().find("--fps: '" + std::string(wrong) + "'"),
              std::string::npos);
  }
  for (const char* wrong : {"0", "-1", "1001", "2.5", "99999999999999999999", "1e2"}) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(parse({"--frames", wrong}), 2) << wrong;
    EXPECT_NE(testing::internal::GetCapturedStderr().find("a whole number from 1 to 1000"),
              std::string::npos);
  }
}

TEST_F(CommandLineTest, ComplaintsNameTheCause) {
  const std::vector<std::pair<std::vector<const char*>, std::string>> wrong = {
      {{"--bogus", "1"}, "'--bogus' '1' (--help"},
      {{"--frame=3"}, "'--frame=3'; did you mean --frames?"},
      {{"x", "--lop"}, "'x' '--lop'; did you mean --loop?"},
      {{"--colour", "gren"}, "'gren' is not one of blue|green; did you mean green?"},
      {{"--colour", "yellow"}, "'yellow' is not one of blue|green (--help"},
      {{"--fps", "2", "--fps", "3"}, "--fps: this flag may appear only once"},
      {{"--loop=maybe"}, "--loop = maybe: a flag is on or off"},
      {{"--fps"}, "--fps: its value is missing"},
      {{"word"}, "'word'; is a flag missing in front of it?"},
  };
  for (const auto& [arguments, words] : wrong) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(parse(arguments), 2);
    const std::string line = testing::internal::GetCapturedStderr();
    EXPECT_NE(line.find(words), std::string::npos) << line;
  }
  app_.add_option("--source")->required();
  testing::internal::CaptureStderr();
  EXPECT_EQ(parse({"--sourc", "x"}), 2);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("'--sourc'"), std::string::npos);
}

TEST(CommandLine, SuggestsSimilarWordsOnly) {
  const std::vector<std::string> words = {"--seconds", "--summary", "--log", "on"};
  EXPECT_EQ(spellingHint("--second", words), "; did you mean --seconds?");
  EXPECT_EQ(spellingHint("--sumamry", words), "; did you mean --summary?") << "swapped";
  EXPECT_EQ(spellingHint("--lgo", words), "; did you mean --log?");
  EXPECT_EQ(spellingHint("no", words), "; did you mean on?");
  EXPECT_EQ(spellingHint("x", words), "");
  EXPECT_EQ(spellingHint("--other", words), "");
  EXPECT_EQ(spellingHint("", words), "");
  EXPECT_EQ(spellingHint(std::string(100'000, '-'), words), "");
}

TEST(CommandLine, ForeignTextCannotSteerATerminal) {
  EXPECT_EQ(sanitizeUtf8("a\x1b[2J\r\n\tb\x7f"), "a?[2J???b?");
  EXPECT_EQ(sanitizeUtf8("größer"), "größer");
}

TEST_F(CommandLineTest, ConfigFileHoldsTheSameKeys) {
  const std::string path =
      folder_.write("program.conf",
                    "# a comment\nobject = 505,330\nobject = 10,20\nlisten = [::1]:90\nfps = 60\n");
  EXPECT_EQ(parse({"--config", path.c_str()}), std::nullopt);
  EXPECT_EQ(points_, (std::vector<Vec2>{{505.0, 330.0}, {10.0, 20.0}}));
  EXPECT_EQ(listen_, (Endpoint{"::1", 90}));
  EXPECT_DOUBLE_EQ(fps_, 60.0);
}

TEST_F(CommandLineTest, NumbersAreFiniteAndWithinTheirRange) {
  for (const char* text : {"nan", "inf", "-1", "0.99", "241", "1e999", "60 ", "6O", "0x20"}) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(parse({"--fps", text}), 2) << text;
    const std::string line = testing::internal::GetCapturedStderr();
    EXPECT_NE(line.find("--fps"), std::string::npos) << line;
    EXPECT_NE(line.find(" is not a number from 1 to 240"), std::string::npos) << line;
  }
  EXPECT_EQ(parse({"--fps", "2.4e2"}), std::nullopt);
  EXPECT_DOUBLE_EQ(fps_, 240.0);
}

TEST_F(CommandLineTest, ConfigFileCollectsAListFromAllItsLines) {
  const std::string path = folder_.write("program.conf", "object = 1,2\nfps = 60\nobject = 3,4\n");
  EXPECT_EQ(parse({"--config", path.c_str()}), std::nullopt);
  EXPECT_EQ(points_, (std::vector<Vec2>{{1.0, 2.0}, {3.0, 4.0}}));
}

TEST_F(CommandLineTest, WrongConfigFileIsReportedWithItsLine) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"fps = 60\n[section]\n", ".conf:2: '[section]' is not a `key = value` line"},
      {"fps\n", ".conf:1: 'fps' is not a `key = value` line"},
      {"-- = 1\n", ".conf:1: '-- = 1' is not a `key = value` line"},
      {"fps = 60\nconfig = other.conf\n", ".conf:2: a config file cannot name another one"},
      {"fsp = 60\n", ".conf:1: 'fsp' is not the name of a flag; did you mean fps?"},
      {"help = true\n", "help"},
      {"fps = 60\nfps = 50\n", ".conf: --fps: this flag may appear only once"},
      {"fps = 600\n", ".conf: --fps: '600' is not a number"},
      {"# " + std::string(70'000, 'x'), ".conf: larger than 64 KiB"}};
  for (const auto& [text, complaint] : wrong) {
    const std::string path = folder_.write("program.conf", text);
    testing::internal::CaptureStderr();
    EXPECT_EQ(parse({"--config", path.c_str()}), 2) << text.substr(0, 40);
    const std::string line = testing::internal::GetCapturedStderr();
    EXPECT_NE(line.find(complaint), std::string::npos) << line;
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
  }
}

TEST_F(CommandLineTest, ConfigFileRefusesUnknownKeys) {
  const std::string path = folder_.write("program.conf", "stifness = 1\n");
  testing::internal::CaptureStderr();
  EXPECT_EQ(parse({"--config", path.c_str()}), 2);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("stifness"), std::string::npos);
}

TEST_F(CommandLineTest, MissingConfigFileIsNamed) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(parse({"--config", "/nowhere/x.conf"}), 2);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("/nowhere/x.conf"), std::string::npos);
}

class CommandLineDefaultFileTest : public testing::Test {
 protected:
  CommandLineDefaultFileTest() {
    addNumber(app_, "--fps", fps_, 1.0, 240.0, "1..240", "rate");
    addConfigFile(app_, (folder_ / "default.conf").string());
  }
  std::optional<int> parse(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "program");
    return parseCommandLine(app_, static_cast<int>(arguments.size()), arguments.data());
  }

  const TempFolder folder_;
  CLI::App app_{"test", "program"};
  double fps_ = 25.0;
};

TEST_F(CommandLineDefaultFileTest, IsReadIfItExists) {
  EXPECT_EQ(parse({}), std::nullopt);
  EXPECT_EQ(fps_, 25.0);
  (void)folder_.write("default.conf", "fps = 50\n");
  EXPECT_EQ(parse({}), std::nullopt);
  EXPECT_EQ(fps_, 50.0);
}

TEST_F(CommandLineDefaultFileTest, AFileOnTheCommandLineReplacesIt) {
  (void)folder_.write("default.conf", "fps = 50\nspeed = 1\n");
  const std::string other = folder_.write("other.conf", "fps = 60\n");
  EXPECT_EQ(parse({"--config", other.c_str()}), std::nullopt);
  EXPECT_EQ(fps_, 60.0);
}

TEST_F(CommandLineDefaultFileTest, AnErrorInItNamesIt) {
  for (const char* wrong : {"fps = 50\nspeed = 1\n", "fps = 900\n"}) {
    const std::string file = folder_.write("default.conf", wrong);
    testing::internal::CaptureStderr();
    EXPECT_EQ(parse({}), 2);
    const std::string line = testing::internal::GetCapturedStderr();
    EXPECT_NE(line.find("--config " + file), std::string::npos) << line;
  }
}

TEST_F(CommandLineDefaultFileTest, AnErrorOnTheCommandLineDoesNotNameAMissingFile) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(parse({"--fps", "900"}), 2);
  const std::string line = testing::internal::GetCapturedStderr();
  EXPECT_EQ(line.find("default.conf"), std::string::npos) << line;
}

}  // namespace
}  // namespace hapticast
