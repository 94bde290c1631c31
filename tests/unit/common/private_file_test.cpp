// SPDX-License-Identifier: MIT
#include "common/private_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/temp_folder.hpp"

namespace hapticast {
namespace {

namespace fs = std::filesystem;

TEST(PrivateFileTest, WritesAFileThatOnlyItsOwnerMayRead) {
  const TempFolder folder;
  const fs::path file = folder / "below/of it/key";
  ASSERT_EQ(writePrivateFile(file, "one\n"), std::nullopt);
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(readSmallFile(file).value(), "one\n");
  fs::permissions(file, fs::perms::owner_all | fs::perms::others_read);
  ASSERT_EQ(writePrivateFile(file, "two\n"), std::nullopt);
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(readSmallFile(file).value(), "two\n");
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 1) << "no other file";
}

TEST(PrivateFileTest, ReportsWhyNot) {
  const TempFolder folder;
  const std::string file = folder.write("file", "text");
  const auto below = writePrivateFile(fs::path(file) / "below", "text");
  ASSERT_TRUE(below.has_value());
  EXPECT_TRUE(below->message.starts_with("cannot be written (")) << below->message;
  const auto onto = writePrivateFile(folder.string(), "text");
  ASSERT_TRUE(onto.has_value()) << "a folder";
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.string()), {}), 1) << "no file is left";
  EXPECT_FALSE(readSmallFile(folder / "missing").ok());
  EXPECT_EQ(readSmallFile(folder.string()).error().message, "cannot be read (it is no file)");
  folder.write("large", std::string(kMaxSmallFile_bytes + 1, 'a'));
  EXPECT_EQ(readSmallFile(folder / "large").error().message,
            "cannot be read (it is larger than 1 MiB)");
}

}  // namespace
}  // namespace hapticast
