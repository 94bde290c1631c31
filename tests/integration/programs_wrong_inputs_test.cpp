// SPDX-License-Identifier: MIT
// wrong_inputs.txt: what a newcomer may type, with the line and the exit code that he gets.
#include <regex>

#include "common/build_options.hpp"
#include "common/cli/parse.hpp"
#include "tests/integration/programs_fixture.hpp"

// main() of server/main.cpp and of client/main.cpp (tests/CMakeLists.txt).
int serverMain(int argc, char** argv);
int clientMain(int argc, char** argv);

namespace hapticast::testing {
namespace {

/// One record of the table.
struct WrongInput {
  std::string program;
  int exit_code = 0;
  std::string arguments;
  std::string lines;
};

/// Words as a shell splits them, '...' round what is empty or has spaces.
std::vector<std::string> wordsOf(const std::string& text) {
  static const std::regex kWord(R"('([^']*)'|(\S+))");
  std::vector<std::string> words;
  for (std::sregex_iterator at(text.begin(), text.end(), kWord), end; at != end; ++at)
    words.push_back((*at)[1].matched ? (*at)[1].str() : (*at)[2].str());
  return words;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at)) {
    text.replace(at, what.size(), by);
    at += by.size();
  }
  return text;
}

/// Runs the main function of a program in this process.
int runMain(const std::string& program, std::vector<std::string> words) {
  const bool is_server = program == "server";
  words.insert(words.begin(), is_server ? HAPTICAST_SERVER_PROGRAM : HAPTICAST_CLIENT_PROGRAM);
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int count = static_cast<int>(words.size());
  return is_server ? serverMain(count, arguments.data()) : clientMain(count, arguments.data());
}

/// The output of a program, without the time and the level in front of each line.
std::string formatLines(const std::string& output) {
  static const std::regex kFront(R"(^[0-9]{2}:[0-9]{2}:[0-9]{2}\.[0-9]{3} (warning|error) )",
                                 std::regex::multiline);
  return std::regex_replace(output, kFront, "");
}

class ProgramsWrongInputsTest : public ProgramsTest {
 protected:
  /// The table; its files are made.
  [[nodiscard]] std::vector<WrongInput> readTable() const {
    std::ifstream in(std::string(HAPTICAST_TESTS) + "/integration/wrong_inputs.txt");
    std::vector<WrongInput> table;
    for (std::string line; std::getline(in, line);) {
      if (line.empty() || line.starts_with('#')) continue;
      if (line.starts_with("    ")) {
        table.back().lines += line.substr(4) + "\n";
        continue;
      }
      std::istringstream words(line);
      std::string first;
      std::string second;
      words >> first >> second;
      std::string rest;
      std::getline(words >> std::ws, rest);
      if (first == "file") {
        write(second, replaced(replaced(rest, "\\n", "\n"), "\\x02", "\x02"));
      } else {
        table.push_back({first, std::stoi(second), rest, ""});
      }
    }
    return table;
  }
};

TEST_F(ProgramsWrongInputsTest, EachGetsExactlyItsLine) {
  const auto table = readTable();
  EXPECT_GE(table.size(), 60U);
  const auto other = startServer({"--source", makeClip("clip"), "--loop"});
  const std::string used = addressOf(*other);
  const std::string folder = path("").substr(0, path("").size() - 1);
  for (const WrongInput& each : table) {
    const bool of_a_name = each.arguments.find("--announce") != std::string::npos ||
                           each.arguments.find("mdns:") != std::string::npos;
    if (of_a_name && !kHasDiscovery) continue;
    const std::string arguments =
        replaced(replaced(each.arguments, "{DIR}", folder), "{USED}", used);
    Process process([&] { return runMain(each.program, wordsOf(arguments)); });
    EXPECT_EQ(process.wait(kSoon), each.exit_code) << each.program << " " << each.arguments;
    EXPECT_EQ(formatLines(process.output()),
              replaced(replaced(each.lines, "{DIR}", folder), "{USED}", used))
        << each.program << " " << each.arguments;
  }
  interrupt(*other);
}

}  // namespace
}  // namespace hapticast::testing
