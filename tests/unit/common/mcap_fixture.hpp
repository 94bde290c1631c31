// SPDX-License-Identifier: MIT
// Shared by the tests of files in the format MCAP: random messages, a file of them, changed bytes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "common/recording/mcap_reader.hpp"
#include "common/recording/mcap_writer.hpp"
#include "common/recording/schemas.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast {

class McapFilesTest : public ::testing::Test {
 protected:
  using Bytes = std::vector<std::uint8_t>;

  struct Kept {
    std::uint16_t channel;
    std::uint64_t time_ns;
    Bytes data;
    bool operator==(const Kept&) const = default;
  };

  static std::vector<Kept> drawMessages(unsigned seed, std::size_t count, std::size_t most_bytes) {
    std::mt19937 random(seed);
    std::vector<Kept> messages;
    std::uint64_t time_ns = 1000;
    for (std::size_t i = 0; i < count; ++i) {
      time_ns += random() % 2'000'000;
      Bytes data(random() % most_bytes);
      std::generate(data.begin(), data.end(), [&] { return static_cast<std::uint8_t>(random()); });
      messages.push_back({static_cast<std::uint16_t>(1 + random() % 3), time_ns, std::move(data)});
    }
    return messages;
  }

  static std::vector<McapChannel> threeChannels() {
    return {makeChannel("/frame", "hapticast.proto.HapticFrame"),
            makeChannel("/picture", "foxglove.CompressedImage"),
            {"/text", "json", {}}};
  }

  static void writeAll(McapWriter& writer, const std::vector<Kept>& messages) {
    for (const Kept& each : messages)
      writer.write(each.channel - std::size_t{1}, each.time_ns, each.data);
  }

  static std::vector<Kept> readAll(McapReader& reader) {
    std::vector<Kept> messages;
    while (const auto message = reader.next())
      messages.push_back(
          {message->channel, message->time_ns, Bytes(message->data.begin(), message->data.end())});
    return messages;
  }

  static Bytes readBytes(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  static void writeBytes(const std::string& file, const Bytes& bytes) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }

  /// Expects that `messages` are the first of `all`.
  static void expectPrefix(const std::vector<Kept>& messages, const std::vector<Kept>& all) {
    ASSERT_LE(messages.size(), all.size());
    EXPECT_TRUE(std::equal(messages.begin(), messages.end(), all.begin()));
  }
  /// Returns a file with a chunk for each 20 of the messages.
  std::string makeFile(const std::vector<Kept>& messages) const {
    std::string file = (folder_ / "a.mcap").string();
    std::filesystem::remove(file);
    McapWriter writer(file, threeChannels());
    for (std::size_t i = 0; i < messages.size(); ++i) {
      writeAll(writer, {messages[i]});
      if (i % 20 == 19) writer.flush();
    }
    return file;
  }
  [[nodiscard]] std::string changed(const Bytes& bytes) const {
    std::string file = (folder_ / "changed.mcap").string();
    writeBytes(file, bytes);
    return file;
  }

  TempFolder folder_;
};

}  // namespace hapticast
