// SPDX-License-Identifier: MIT
#include "common/text.hpp"

#include <gtest/gtest.h>

#include <random>
#include <sstream>

namespace hapticast {
namespace {

Result<std::vector<KeyValue>> read(const std::string& text) {
  std::istringstream in(text);
  return readKeyValues(in, "f");
}
std::string complaint(const std::string& text) {
  const auto result = read(text);
  return result.ok() ? "accepted" : result.error().message;
}

TEST(ReadKeyValues, AHashWithinAWordBeginsNoComment) {
  std::istringstream in(
      "object = 505,330#2  # the second candidate\n#all\ncommand = ./x '#fff'\t#end\n");
  const auto result = readKeyValues(in, "f");
  ASSERT_TRUE(result.ok()) << result.error().message;
  ASSERT_EQ(result.value().size(), 2U);
  EXPECT_EQ(result.value()[0].value, "505,330#2");
  EXPECT_EQ(result.value()[1].value, "./x '#fff'");
}

TEST(Text, NumbersAreWholeAndFinite) {
  EXPECT_EQ(parseNumber("-1.5e2"), -150.0);
  EXPECT_EQ(parseNumber("0"), 0.0);
  for (const char* text : {"", " 1", "1 ", "+1", "1,0", "1x", "nan", "inf", "1e999", "-", "0x10"}) {
    EXPECT_FALSE(parseNumber(text)) << text;
  }
}

TEST(Text, QuotesAreCutAfterFortyBytes) {
  EXPECT_EQ(quote("a b"), "'a b'");
  EXPECT_EQ(quote(std::string(41, 'x')), "'" + std::string(40, 'x') + "...'");
}

TEST(Text, QuotesAreCutBetweenTwoCharacters) {
  const std::string letters = std::string(39, 'x') + "\xC3\xA9";
  EXPECT_EQ(quote(letters), "'" + std::string(39, 'x') + "...'");
  EXPECT_EQ(quote(letters.substr(1)), "'" + letters.substr(1) + "'");
}

TEST(Text, QuotesShowControlAndHiddenCharactersByTheirCodes) {
  EXPECT_EQ(quote("a\x1B[2J\n"), "'a\\x1B[2J\\x0A'");
  EXPECT_EQ(quote(std::string_view("\xFF\xFE"
                                   "a\0",
                                   4)),
            "'\\xFF\\xFEa\\x00'")
      << "UTF-16";
  EXPECT_EQ(quote("\xC2\x85\xE2\x80\xAE"), "'\\xC2\\x85\\xE2\\x80\\xAE'") << "C1, direction";
  EXPECT_EQ(quote("gr\xC3\xBC\xC3\x9F\\"), "'gr\xC3\xBC\xC3\x9F\\'") << "letters stay";
}

/// Random bytes in quotes are one line of UTF-8 that cannot control a terminal, and have a limit.
TEST(Text, QuotesOfRandomBytesAreHarmless) {
  std::mt19937 random(5);
  for (int round = 0; round < 5000; ++round) {
    std::string text(random() % 60, '\0');
    for (char& each : text)
      each = random() % 3 == 0 ? static_cast<char>("\xE2\x80\xAE\xC3\xA9x"[random() % 6])
                               : static_cast<char>(random());
    const std::string quoted = quote(text);
    ASSERT_EQ(sanitizeUtf8(quoted), quoted);
    ASSERT_LE(quoted.size(), 4U * 40U + 5U);
    ASSERT_EQ(quoted.ends_with("...'"), text.size() > 40 || text.ends_with("..."));
  }
}

TEST(Text, KeyValueLinesWithCommentsSpaceAndQuotes) {
  const auto result = read(
      "# first\r\n\n  fps=60  # rate\r\nmax-clients =\t3\nfile = \"a b\"\nfile = 'c'\nempty =\n"
      "q = \"\nx_2 = a = b");
  ASSERT_TRUE(result.ok());
  std::string all;
  for (const KeyValue& pair : result.value()) {
    all += std::to_string(pair.line) + ":" + pair.key + "=" + pair.value + "|";
  }
  EXPECT_EQ(all, "3:fps=60|4:max-clients=3|5:file=a b|6:file=c|7:empty=|8:q=\"|9:x_2=a = b|");
}

TEST(Text, AByteOrderMarkIsIgnored) {
  const auto result = read("\xEF\xBB\xBFsource = synthetic:still\r\n");
  ASSERT_TRUE(result.ok()) << result.error().message;
  ASSERT_EQ(result.value().size(), 1U);
  EXPECT_EQ(result.value()[0].key, "source");
  EXPECT_NE(complaint("a = 1\n\xEF\xBB\xBF"
                      "b = 1"),
            "accepted")
      << "at the begin only";
}

TEST(Text, OtherLinesAreReportedWithTheirNumber) {
  EXPECT_EQ(complaint("a = 1\nb"), "f:2: 'b' is not a `key = value` line");
  EXPECT_EQ(complaint("= 1"), "f:1: '= 1' is not a `key = value` line");
  for (const char* text : {"[a]", "[a = 1]", "-- = 1", "++ = 1", "2a = 1", "a b = 1", "a.b = 1"}) {
    EXPECT_NE(complaint(text), "accepted") << text;
  }
  EXPECT_NE(complaint(std::string("a\0b = 1", 7)), "accepted");
  EXPECT_EQ(complaint(std::string(64, 'k') + " = 1"), "accepted");
  EXPECT_NE(complaint(std::string(65, 'k') + " = 1"), "accepted");
}

TEST(Text, ABinaryFileIsReportedWithoutItsBytes) {
  const std::string all(
      "\x7f"
      "ELF\x02\x01\x01\0 = 1\n",
      13);
  EXPECT_EQ(complaint(all), "f: is not a text file; save it as plain text in UTF-8");
  EXPECT_EQ(complaint(std::string("a\0b = 1", 7)), complaint(all));
  EXPECT_EQ(complaint("a = 1\r\n\tb = 2\r\n"), "accepted");
}

TEST(Text, TheEndingOfAFileMayHaveCapitalLetters) {
  for (const char* file : {"a.png", "A.PNG", "folder.d/a.b.Png", "./a.png"})
    EXPECT_TRUE(hasEnding(file, ".png")) << file;
  for (const char* file : {"", "png", ".png", "folder/.png", "a.png/", "a.png.txt", "a.pn", "apng"})
    EXPECT_FALSE(hasEnding(file, ".png")) << file;
}

TEST(Text, SizeIsLimited) {
  EXPECT_EQ(complaint(std::string(65'536, '\n')), "accepted");
  EXPECT_EQ(complaint(std::string(65'537, '\n')), "f: larger than 64 KiB");
  EXPECT_EQ(complaint(""), "accepted");
}

TEST(Text, AStreamThatFailsIsReported) {
  std::istringstream in("a = 1");
  in.setstate(std::ios::failbit);
  const auto result = readKeyValues(in, "f");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().message, "f: cannot be read");
}

}  // namespace
}  // namespace hapticast
