// SPDX-License-Identifier: MIT
#include "common/write_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "tests/support/temp_folder.hpp"

namespace hapticast {
namespace {

TEST(WriteFile, WritesAllBytesAndReportsWhyNot) {
  const TempFolder folder;
  const std::vector<unsigned char> bytes(100'000, 7);
  const std::string file = (folder / "a.png").string();
  EXPECT_EQ(writeFile(file, bytes), std::nullopt);
  EXPECT_EQ(std::filesystem::file_size(file), bytes.size());
  const auto error = writeFile((folder / "no folder/a.png").string(), bytes);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->message, "cannot be written (No such file or directory)");
  const auto full = writeFile("/dev/full", bytes);
  ASSERT_TRUE(full);
  EXPECT_EQ(full->message, "cannot be written (No space left on device)");
  EXPECT_TRUE(std::filesystem::exists("/dev/full")) << "it removes files only";
}

}  // namespace
}  // namespace hapticast
