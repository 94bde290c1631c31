// SPDX-License-Identifier: MIT
// Access tokens: files, roles, expiry, and refusals.
#include "server/stream/access_list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/stream/key_file.hpp"
#include "tests/support/log_lines.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::server {
namespace {

using std::chrono::system_clock;
using ::testing::HasSubstr;

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
                                      " operator never\r\n");
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
  const auto list = AccessList::parse(digestOf("wonder") + " viewer 9999-12-31");
  ASSERT_TRUE(list.ok());
  EXPECT_FALSE(list.value().find("wonder")->expired(day(2200, 1, 1)));
}

TEST(AccessList, AGrantThatIsRemovedOrChangedIsNotPermitted) {
  const std::string digest = digestOf("wonder");
  const auto before = AccessList::parse(digest + " operator never");
  const auto after = AccessList::parse(digest + " viewer never");
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
      {"\nwonder viewer never", "2: 'wonder' is no SHA-256"},
      {digest, "1: '' is not viewer or operator"},
      {digest + " admin never", "'admin' is not viewer or operator"},
      {digest + " viewer", "'' is not YYYY-MM-DD or never"},
      {digest + " viewer 2026-02-30", "'2026-02-30' is not YYYY-MM-DD or never"},
      {digest + " viewer 26-02-03", "is not YYYY-MM-DD"},
      {digest + " viewer 2026-2-003", "is not YYYY-MM-DD"},
      {digest + " viewer never ever", "'ever' is too much"},
      {digest + " viewer never\n" + digest + " operator never",
       "2: this token is in the file twice"},
  };
  for (const auto& [text, why] : wrong) {
    const auto list = AccessList::parse(text);
    ASSERT_FALSE(list.ok()) << text;
    EXPECT_THAT(list.error().message, HasSubstr(why));
  }
}

TEST(AccessList, AFileThatOthersMayReadGetsAWarning) {
  const TempFolder folder;
  const std::string file = folder.write("tokens", digestOf("wonder") + " viewer never\n");
  std::filesystem::permissions(file, std::filesystem::perms(0644));
  const LogLines log;
  EXPECT_EQ(loadAccessList(file).size(), 1U);
  EXPECT_THAT(log.text(), HasSubstr("--tokens " + file + ": other users may use this file"));
  std::filesystem::permissions(file, std::filesystem::perms(0600));
  (void)loadAccessList(file);
  EXPECT_EQ(log.count(), 1);
  EXPECT_THROW((void)loadAccessList(folder.string() + "/none"), KeyFileError);
  EXPECT_THROW((void)loadAccessList(folder.write("bad", "x")), KeyFileError);
}

}  // namespace
}  // namespace hapticast::server
