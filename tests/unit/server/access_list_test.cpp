// SPDX-License-Identifier: MIT
// Access tokens: files, roles, expiry, and refusals.
#include "server/stream/access_list.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/stream/key_file.hpp"
#include "tests/support/log_lines.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::server {
namespace {

using std::chrono::system_clock;
using ::testing::HasSubstr;
using ::testing::Not;

std::string digestOf(const std::string& token) {
  // The list is the only code here that computes the digest, so the test asks another program.
  const std::string command = "printf %s '" + token + "' | sha256sum";
  FILE* const pipe = ::popen(command.c_str(), "r");
  std::string text(64, '\0');
  EXPECT_EQ(std::fread(text.data(), 1, 64, pipe), 64U);
  ::pclose(pipe);
  return text;
}

system_clock::time_point day(int year, unsigned month, unsigned number) {
  return std::chrono::sys_days(std::chrono::year(year) / std::chrono::month(month) /
                               std::chrono::day(number));
}

TEST(AccessList, HasTokensWithRolesAndTheirLastDays) {
  const auto list = AccessList::parse("# who may come\n" + digestOf("wonder") +
                                      "  viewer 2027-02-28 # Alice\n\n" + digestOf("boss") +
                                      " operator never\r\n# the end\n");
  ASSERT_TRUE(list.ok()) << list.error().message;
  EXPECT_EQ(list.value().size(), 2U);
  const auto viewer = list.value().find("wonder");
  ASSERT_TRUE(viewer);
  EXPECT_EQ(viewer->role, Role::kViewer);
  EXPECT_FALSE(viewer->expired(day(2027, 2, 28) + std::chrono::hours(23)));
  EXPECT_TRUE(viewer->expired(day(2027, 3, 1)));
  EXPECT_TRUE(list.value().permits(*viewer, day(2027, 1, 1)));
  EXPECT_FALSE(list.value().permits(*viewer, day(2027, 3, 1)));
  const auto boss = list.value().find("boss");
  ASSERT_TRUE(boss);
  EXPECT_EQ(boss->role, Role::kOperator);
  EXPECT_FALSE(boss->expired(day(2200, 1, 1)));
  for (const char* wrong : {"", "wonde", "wonders", "Wonder"})
    EXPECT_FALSE(list.value().find(wrong)) << wrong;
}

TEST(AccessList, ADayFarInTheFutureIsADay) {
  const auto list = AccessList::parse(digestOf("wonder") + " viewer 9999-12-31\n");
  ASSERT_TRUE(list.ok());
  EXPECT_FALSE(list.value().find("wonder")->expired(day(2200, 1, 1)));
}

TEST(AccessList, AGrantThatIsRemovedOrChangedIsNotPermitted) {
  const std::string digest = digestOf("wonder");
  const auto before = AccessList::parse(digest + " operator never\n");
  const auto after = AccessList::parse(digest + " viewer never\n");
  const auto empty = AccessList::parse("");
  ASSERT_TRUE(before.ok() && after.ok() && empty.ok());
  const Grant grant = *before.value().find("wonder");
  EXPECT_TRUE(before.value().permits(grant, day(2026, 1, 1)));
  EXPECT_FALSE(after.value().permits(grant, day(2026, 1, 1)));
  EXPECT_FALSE(empty.value().permits(grant, day(2026, 1, 1)));
}

TEST(AccessList, RefusesWithTheLine) {
  const std::string digest = digestOf("wonder");
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"\nwonder viewer never",
       "2: the first word is no SHA-256 (64 hex digits); the file has "
       "digests, not tokens; the form is SHA256 viewer|operator "},
      {digest, "1: the second word is not viewer or operator"},
      {digest + " admin never", "the second word is not viewer or operator"},
      {digest + " viewer", "the third word is not YYYY-MM-DD or never"},
      {digest + " viewer 2026-02-30", "the third word is not YYYY-MM-DD or never"},
      {digest + " viewer 26-02-03", "the third word is not YYYY-MM-DD"},
      {digest + " viewer 2026-2-003", "the third word is not YYYY-MM-DD"},
      {digest + " viewer never ever", "there are more than three words"},
      {digest + " viewer never\n" + digest + " operator never",
       "2: this token is in the file twice"},
  };
  for (const auto& [text, why] : wrong) {
    const auto list = AccessList::parse(text + "\n");
    ASSERT_FALSE(list.ok()) << text;
    EXPECT_THAT(list.error().message, HasSubstr(why));
  }
}

TEST(AccessList, NoErrorHasAWordOfTheFile) {
  const std::string digest = digestOf("wonder");
  const std::string token = "5ecret";
  for (const char* const form :
       {"{0}", "{0} viewer never", "viewer {0} never", "{1} {0}", "{1} {0} never", "{1} viewer {0}",
        "{1} viewer never {0}", "{1}{0} viewer never"}) {
    const std::string line = fmt::format(fmt::runtime(form), token, digest);
    const auto list = AccessList::parse(line + "\n");
    ASSERT_FALSE(list.ok()) << line;
    EXPECT_THAT(list.error().message, Not(HasSubstr(token)));
    EXPECT_THAT(list.error().message, Not(HasSubstr(digest)));
  }
}

/// A file that is written in place is read at any time: no part of it but whole lines is a list.
TEST(AccessList, ABeginOfATextIsAListOnlyAtTheEndOfALine) {
  const std::string text = "# who\n" + digestOf("wonder") + " viewer never # Alice\n\n" +
                           digestOf("boss") + " operator 2030-01-01\n";
  for (std::size_t size = 1; size <= text.size(); ++size) {
    const auto list = AccessList::parse(text.substr(0, size));
    EXPECT_EQ(list.ok(), text[size - 1] == '\n') << size;
    if (list.ok()) continue;
    EXPECT_THAT(list.error().message, HasSubstr("the last line is not complete: end it with"));
  }
}

TEST(AccessList, AFileThatOthersMayReadGetsAWarning) {
  const TempFolder folder;
  const std::string file = folder.write("tokens", digestOf("wonder") + " viewer never\n");
  std::filesystem::permissions(file, std::filesystem::perms(0644));
  const LogLines log;
  const ManualClock clock;
  LimitedLog limited(clock);
  EXPECT_EQ(loadAccessList(file, limited).size(), 1U);
  EXPECT_THAT(log.text(), HasSubstr("--tokens " + file + ": other users may use this file"));
  std::filesystem::permissions(file, std::filesystem::perms(0600));
  (void)loadAccessList(file, limited);
  EXPECT_EQ(log.count(), 1);
  EXPECT_THROW((void)loadAccessList(folder.string() + "/none", limited), KeyFileError);
  EXPECT_THROW((void)loadAccessList(folder.write("bad", "x\n"), limited), KeyFileError);
  std::filesystem::permissions(file, std::filesystem::perms(0644));
  for (int i = 0; i < 50; ++i) (void)loadAccessList(file, limited);
  EXPECT_EQ(log.count(), RateLimiter::kLogBurst) << "a reload may come again and again";
}

TEST(AccessList, AFileWithoutATokenIsAnError) {
  const TempFolder folder;
  const ManualClock clock;
  LimitedLog log(clock);
  for (const char* text : {"", "\n", "# no tokens yet\n\n"}) {
    const std::string file = folder.write("tokens", text);
    try {
      (void)loadAccessList(file, log);
      FAIL() << text;
    } catch (const KeyFileError& error) {
      EXPECT_THAT(error.what(), HasSubstr("--tokens " + file +
                                          ": has no token, so no client could "
                                          "connect; add lines SHA256 viewer|operator"));
    }
  }
}

}  // namespace
}  // namespace hapticast::server
