// SPDX-License-Identifier: MIT
// Files in the format MCAP of other programs: every compression, chunks with wrong sizes.
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <zstd.h>

#include <functional>

#include "common/recording/mcap_compression.hpp"
#include "tests/unit/common/mcap_fixture.hpp"

namespace hapticast {
namespace {

class McapForeign : public McapFilesTest {
 protected:
  /// A file of another program: head, then the records, without a summary.
  static Bytes makeForeign(const std::function<void(McapOut&)>& writeRecords) {
    Bytes bytes(kMcapMagic.begin(), kMcapMagic.end());
    McapOut out(bytes);
    const std::size_t place = out.beginRecord(McapCode::kHeader);
    out.text("ros2").text("other");
    out.endRecord(place);
    writeRecords(out);
    return bytes;
  }

  static Bytes makeRecords(const std::vector<Kept>& messages) {
    Bytes bytes;
    McapOut out(bytes);
    out.writeSchema(7, {"sensor_msgs/msg/Image", "ros2msg", "uint32 height"});
    for (std::uint16_t id = 1; id <= 3; ++id)
      out.writeChannel(id, id == 1 ? std::uint16_t{7} : std::uint16_t{0}, {"/a", "cdr", {}});
    for (const Kept& each : messages) {
      const std::size_t place = out.beginRecord(McapCode::kMessage);
      out.number(each.channel).number(std::uint32_t{0}).number(each.time_ns).number(each.time_ns);
      out.data(each.data);
      out.endRecord(place);
    }
    return bytes;
  }

  static void writeChunk(McapOut& out, const std::string& compression, std::uint64_t size,
                         std::uint32_t crc, const Bytes& bytes) {
    const std::size_t place = out.beginRecord(McapCode::kChunk);
    out.number(std::uint64_t{0}).number(std::uint64_t{0}).number(size).number(crc);
    out.text(compression).number(std::uint64_t{bytes.size()}).data(bytes);
    out.endRecord(place);
  }

  static Bytes compress(const std::string& compression, const Bytes& bytes) {
    Bytes out(ZSTD_compressBound(bytes.size()) + LZ4F_compressFrameBound(bytes.size(), nullptr));
    out.resize(
        compression == "zstd"
            ? ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3)
            : LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr));
    return out;
  }
};

TEST_F(McapForeign, FilesOfOtherProgramsAreRead) {
  const auto messages = drawMessages(10, 500, 200);
  const Bytes records = makeRecords(messages);
  for (const std::string compression : {"", "zstd", "lz4", "none"}) {
    const std::string file = changed(makeForeign([&](McapOut& out) {
      if (compression == "none") {  // no chunk at all
        out.data(records);
      } else {
        writeChunk(out, compression, records.size(), computeCrc32(records),
                   compression.empty() ? records : compress(compression, records));
      }
    }));
    auto opened = McapReader::open(file);
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    McapReader reader = std::move(opened).value();
    EXPECT_EQ(readAll(reader), messages) << compression;
    EXPECT_EQ(reader.channels().at(1).schema.name, "sensor_msgs/msg/Image");
  }
}

TEST_F(McapForeign, ZerosInAChunkAreDamage) {
  const auto messages = drawMessages(12, 20, 200);
  Bytes records = makeRecords(messages);
  records.resize(records.size() + (64U << 20U));
  const auto read = [&](const Bytes& content) {
    auto opened = McapReader::open(changed(makeForeign([&](McapOut& out) {
      writeChunk(out, "zstd", content.size(), 0, compress("zstd", content));
    })));
    if (!opened.ok()) return opened.error().message;
    McapReader reader = std::move(opened).value();
    EXPECT_EQ(readAll(reader), messages);
    return reader.problem();
  };
  EXPECT_EQ(read(records), "has a damaged chunk");
  EXPECT_EQ(read(Bytes(64U << 20U)), "has no messages: it has a damaged chunk");
}

TEST_F(McapForeign, AScanEndsAtADamagedChunk) {
  const Bytes zeros(1000);
  const auto messages = drawMessages(14, 20, 200);
  const Bytes records = makeRecords(messages);
  std::vector<double> shares;
  auto opened = McapReader::open(changed(makeForeign([&](McapOut& out) {
                                   writeChunk(out, "", records.size(), 0, records);
                                   for (int i = 0; i < 20; ++i) writeChunk(out, "", 1000, 0, zeros);
                                 })),
                                 [&](double share) { shares.push_back(share); });
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ(shares.size(), 3U) << "the header, the messages, the first zeros";
  McapReader reader = std::move(opened).value();
  EXPECT_EQ(readAll(reader), messages);
  EXPECT_EQ(reader.problem(), "has a damaged chunk");
}

TEST_F(McapForeign, FloodsOfRecordsAreRefused) {
  const auto messages = drawMessages(15, 20, 200);
  const Bytes records = makeRecords(messages);
  Bytes unknown, empty;
  for (int i = 0; i < 1'000'000; ++i) {
    McapOut(unknown).number(std::uint8_t{0x90}).number(std::uint64_t{0});
    McapOut(empty).number(static_cast<std::uint8_t>(McapCode::kMessage)).number(std::uint64_t{0});
  }
  const auto read = [&](const Bytes& flood) {
    auto opened = McapReader::open(changed(makeForeign([&](McapOut& out) {
      writeChunk(out, "", records.size(), 0, records);
      writeChunk(out, "zstd", flood.size(), 0, compress("zstd", flood));
    })));
    EXPECT_TRUE(opened.ok());
    McapReader reader = std::move(opened).value();
    EXPECT_EQ(readAll(reader), messages);
    return reader.problem();
  };
  EXPECT_EQ(read(unknown), "has a chunk of too many records");
  EXPECT_EQ(read(empty), "has a chunk of too many records");
  EXPECT_EQ(read(makeRecords(std::vector<Kept>(1'000'000, {1, 7, {}}))),
            "has a chunk of too many records");
}

TEST_F(McapForeign, TheSmallestMessagesAreRead) {
  // Without data: equal ones of a simulation that pauses, and ones with regular times.
  const std::vector<Kept> equal(130'000, {1, 7, {}});
  std::vector<Kept> regular;
  for (std::uint64_t i = 0; i < 500'000; ++i) regular.push_back({1, 1'000'000 * i, {}});
  for (const auto& messages : {equal, regular}) {
    for (const std::string compression : {"zstd", "lz4"}) {
      const Bytes records = makeRecords(messages);
      auto opened = McapReader::open(changed(makeForeign([&](McapOut& out) {
        writeChunk(out, compression, records.size(), 0, compress(compression, records));
      })));
      ASSERT_TRUE(opened.ok()) << opened.error().message;
      McapReader reader = std::move(opened).value();
      EXPECT_TRUE(readAll(reader) == messages) << compression << ": " << reader.problem();
    }
  }
}

TEST_F(McapForeign, ChunksWithWrongSizesAreRefused) {
  const Bytes records = makeRecords(drawMessages(11, 20, 200));
  const Bytes large(10U << 20U, 0);
  const auto refuse = [&](const std::string& compression, std::uint64_t size, const Bytes& bytes) {
    auto opened = McapReader::open(
        changed(makeForeign([&](McapOut& out) { writeChunk(out, compression, size, 0, bytes); })));
    return opened.ok() ? "" : opened.error().message;
  };
  for (const std::string compression : {"zstd", "lz4"}) {
    const Bytes packed = compress(compression, records);
    EXPECT_EQ(refuse(compression, std::uint64_t{1} << 63U, packed),
              "has no messages: it has a chunk of more than 256 MiB");
    const std::string damaged = "has no messages: it has a damaged chunk";
    EXPECT_EQ(refuse(compression, records.size() - 1, packed), damaged);
    EXPECT_EQ(refuse(compression, records.size() + 1, packed), damaged);
    EXPECT_EQ(refuse(compression, records.size(), records), damaged);
    EXPECT_EQ(refuse(compression, 100, compress(compression, large)), damaged) << "a bomb";
  }
  EXPECT_EQ(refuse("", records.size() + 1, records), "has no messages: it has a damaged chunk");
  EXPECT_EQ(refuse("brotli", 1, records),
            "has no messages: it has the unknown compression 'brotli'");
  const Bytes cut = makeForeign(
      [&](McapOut& out) { out.number(std::uint8_t{6}).number(std::uint64_t{1} << 63U); });
  const auto opened = McapReader::open(changed(cut));
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.error().message, "has no messages: it is cut off");
}

}  // namespace
}  // namespace hapticast
