// SPDX-License-Identifier: MIT
// The error of a reader of a device's files for a wrong text.
#pragma once

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>
#include <string>

namespace hapticast::client {

/// The error of read(stream, file name), without the file's name; "accepted" if there is none.
template <class Read>
std::string complaint(Read read, const std::string& text) {
  std::istringstream in(text);
  try {
    (void)read(in, "a file");
  } catch (const std::runtime_error& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find("a file:"), 0U) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what.substr(std::min<std::size_t>(what.size(), 6));
  }
  return "accepted";
}

}  // namespace hapticast::client
