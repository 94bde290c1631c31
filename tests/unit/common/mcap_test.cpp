// SPDX-License-Identifier: MIT
// Files in the format MCAP: what the writer writes, the reader reads; damage ends the reading with
// a sentence and never with wrong messages.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>

#include "common/recording/mcap_compression.hpp"
#include "common/recording/mcap_reader.hpp"
#include "common/recording/mcap_writer.hpp"
#include "common/recording/recorder.hpp"
#include "common/recording/schemas.hpp"
#include "tests/unit/common/mcap_fixture.hpp"

namespace hapticast {
namespace {

class Mcap : public McapFilesTest {};

TEST_F(Mcap, TheReaderReturnsWhatTheWriterWrote) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto messages = drawMessages(seed, 3000, seed == 1 ? 5000 : 300);
    const std::string file = (folder_ / ("a" + std::to_string(seed))).string();
    {
      McapWriter writer(file, threeChannels());
      writeAll(writer, messages);
      writer.finish();
      EXPECT_EQ(writer.written(), messages.size());
      EXPECT_EQ(writer.lost(), 0U);
    }
    auto opened = McapReader::open(file);
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    McapReader reader = std::move(opened).value();
    ASSERT_EQ(reader.channels().size(), 3U);
    EXPECT_EQ(reader.channels().at(1).topic, "/frame");
    EXPECT_EQ(reader.channels().at(1).schema.name, "hapticast.proto.HapticFrame");
    EXPECT_EQ(reader.channels().at(3).message_encoding, "json");
    EXPECT_EQ(reader.end_ns(), messages.back().time_ns);
    EXPECT_EQ(readAll(reader), messages);
    EXPECT_EQ(reader.problem(), "");
  }
}

TEST_F(Mcap, EachMessageIsFoundAgainAtItsPlace) {
  const auto messages = drawMessages(7, 500, 100);
  auto opened = McapReader::open(makeFile(messages));
  ASSERT_TRUE(opened.ok());
  McapReader reader = std::move(opened).value();
  std::vector<McapPlace> places;
  while (reader.next()) places.push_back(reader.place());
  ASSERT_EQ(places.size(), messages.size());
  std::mt19937 random(8);
  for (int i = 0; i < 1000; ++i) {
    const std::size_t wanted = random() % messages.size();
    reader.seek(places[wanted]);
    for (std::size_t at = wanted; at < std::min(wanted + 3, messages.size()); ++at) {
      const auto message = reader.next();
      ASSERT_TRUE(message);
      EXPECT_EQ(message->time_ns, messages[at].time_ns);
      EXPECT_EQ(reader.place(), places[at]);
    }
  }
}

TEST_F(Mcap, ReadersOfOneFileShareItsIndexAndChunksAndNoPlace) {
  const auto messages = drawMessages(9, 3000, 200);
  auto opened = McapReader::open(makeFile(messages));
  ASSERT_TRUE(opened.ok());
  std::vector<McapReader> readers;
  readers.reserve(5);
  for (int i = 0; i < 5; ++i) readers.push_back(opened.value().reopen().value());
  std::vector<std::size_t> places(readers.size(), 0);
  std::mt19937 random(10);
  for (int i = 0; i < 20'000; ++i) {
    const std::size_t one = random() % readers.size();
    if (random() % 400 == 0) {
      const std::size_t wanted = random() % messages.size();
      readers[one].seek(messages[wanted].time_ns);
      while (const auto message = readers[one].next()) {
        if (message->time_ns < messages[wanted].time_ns) continue;
        places[one] = static_cast<std::size_t>(
            std::find_if(messages.begin(), messages.end(),
                         [&](const Kept& each) { return each.time_ns == message->time_ns; }) -
            messages.begin() + 1);
        break;
      }
      continue;
    }
    const auto message = readers[one].next();
    ASSERT_EQ(message.has_value(), places[one] < messages.size()) << one;
    if (!message) continue;
    const Kept& expected = messages[places[one]++];
    ASSERT_EQ(message->time_ns, expected.time_ns);
    ASSERT_TRUE(std::equal(message->data.begin(), message->data.end(), expected.data.begin(),
                           expected.data.end()));
  }
}

TEST_F(Mcap, AFifoIsRefusedWithoutAWait) {
  const std::string fifo = (folder_ / "fifo.mcap").string();
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(McapReader::open(fifo).error().message, "is no MCAP file");
}

TEST_F(Mcap, OneBlockHasTheFirstChannels) {
  const auto messages = drawMessages(9, 100, 100);
  Bytes bytes = readBytes(makeFile(messages));
  bytes.resize(bytes.size() - 20);  // without the summary, so the file is scanned
  auto opened = McapReader::open(changed(bytes), {}, 1);
  ASSERT_TRUE(opened.ok());
  McapReader reader = std::move(opened).value();
  EXPECT_EQ(reader.channels().size(), 3U);
  EXPECT_EQ(readAll(reader).size(), 20U);
}

TEST_F(Mcap, AScanReportsItsShareAndASummaryNeedsNone) {
  const auto messages = drawMessages(10, 200, 100);
  const std::string file = makeFile(messages);
  std::vector<double> shares;
  const auto progress = [&](double share) { shares.push_back(share); };
  ASSERT_TRUE(McapReader::open(file, progress).ok());
  EXPECT_TRUE(shares.empty());
  Bytes bytes = readBytes(file);
  bytes.resize(bytes.size() - 20);
  auto opened = McapReader::open(changed(bytes), progress);
  ASSERT_TRUE(opened.ok());
  EXPECT_GE(shares.size(), 10U) << "one for each chunk";
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GE(shares.front(), 0.0);
  EXPECT_LE(shares.back(), 1.0);
  McapReader reader = std::move(opened).value();
  EXPECT_EQ(reader.share(), 0.0);
  EXPECT_EQ(readAll(reader), messages);
  EXPECT_EQ(reader.share(), 1.0);
}

TEST_F(Mcap, SeekContinuesWithTheChunkOfTheTime) {
  const auto messages = drawMessages(6, 1000, 100);
  auto opened = McapReader::open(makeFile(messages));
  ASSERT_TRUE(opened.ok());
  McapReader reader = std::move(opened).value();
  for (const std::size_t wanted : {500U, 0U, 999U, 20U, 19U}) {
    reader.seek(messages[wanted].time_ns);
    const auto rest = readAll(reader);
    ASSERT_LE(rest.size(), messages.size());
    const std::size_t first = messages.size() - rest.size();
    EXPECT_LE(first, wanted);
    EXPECT_LT(wanted - first, 20U);
    EXPECT_TRUE(
        std::equal(rest.begin(), rest.end(), messages.end() - static_cast<long>(rest.size())));
  }
  reader.seek(messages.back().time_ns + 1);
  EXPECT_FALSE(reader.next());
}

TEST_F(Mcap, ACutFilePlaysUpToItsLastWholeChunk) {
  const auto messages = drawMessages(7, 200, 100);
  const Bytes bytes = readBytes(makeFile(messages));
  std::size_t most = 0;
  for (std::size_t length = 0; length < bytes.size(); length += 97) {
    auto opened =
        McapReader::open(changed({bytes.begin(), bytes.begin() + static_cast<long>(length)}));
    if (!opened.ok()) continue;
    McapReader reader = std::move(opened).value();
    const auto read = readAll(reader);
    expectPrefix(read, messages);
    EXPECT_EQ(read.size() % 20, 0U);
    // Behind the last chunk there is the summary, which can be done without.
    if (read.size() < messages.size()) {
      EXPECT_EQ(reader.problem(), "is cut off");
    }
    EXPECT_GE(read.size(), most);
    most = read.size();
  }
  EXPECT_EQ(most, messages.size());
}

TEST_F(Mcap, ADamagedByteNeverGivesAWrongMessage) {
  const auto messages = drawMessages(8, 100, 60);
  const Bytes bytes = readBytes(makeFile(messages));
  std::mt19937 random(8);
  int problems = 0;
  for (int i = 0; i < 2000; ++i) {
    Bytes damaged = bytes;
    damaged[random() % damaged.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
    auto opened = McapReader::open(changed(damaged));
    if (!opened.ok()) {
      ++problems;
      continue;
    }
    McapReader reader = std::move(opened).value();
    const auto read = readAll(reader);
    problems += reader.problem().empty() ? 0 : 1;
    // A wrong place in the index may leave out chunks, and a wrong channel its messages.
    for (const Kept& each : read)
      EXPECT_NE(std::find(messages.begin(), messages.end(), each), messages.end());
  }
  EXPECT_GT(problems, 300) << "the rest of the bytes are schemas";
}

TEST_F(Mcap, AWrongChecksumEndsTheMessages) {
  const auto messages = drawMessages(9, 100, 60);
  Bytes bytes = readBytes(makeFile(messages));
  const auto place =
      std::search(bytes.begin(), bytes.end(), messages[50].data.begin(), messages[50].data.end());
  ASSERT_NE(place, bytes.end());
  *place ^= 1;
  auto opened = McapReader::open(changed(bytes));
  ASSERT_TRUE(opened.ok());
  McapReader reader = std::move(opened).value();
  const auto read = readAll(reader);
  EXPECT_EQ(read.size(), 40U);
  expectPrefix(read, messages);
  EXPECT_EQ(reader.problem(), "has a wrong checksum");
}

TEST_F(Mcap, OtherFilesAreRefused) {
  const auto refuse = [](const std::string& file) {
    const auto opened = McapReader::open(file);
    return opened.ok() ? "" : opened.error().message;
  };
  EXPECT_EQ(refuse("/no/file"), "cannot be read (No such file or directory)");
  EXPECT_EQ(refuse(folder_.string()), "is no MCAP file");
  EXPECT_EQ(refuse(folder_.write("empty", "")), "is no MCAP file");
  EXPECT_EQ(refuse(folder_.write("text", std::string(1000, 'x'))), "is no MCAP file");
  const std::string file = (folder_ / "made.mcap").string();
  { const McapWriter writer(file, threeChannels()); }
  EXPECT_EQ(refuse(file), "has no messages");
  try {
    const McapWriter writer(file, threeChannels());
    ADD_FAILURE() << "it replaces a file";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "exists already: choose another name, or remove it");
  }
}

/// While it lives, files cannot grow beyond a limit.
class UntrustedClientsFileLimit {
 public:
  explicit UntrustedClientsFileLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    signal_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~UntrustedClientsFileLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    (void)std::signal(SIGXFSZ, signal_);
  }
  UntrustedClientsFileLimit(const UntrustedClientsFileLimit&) = delete;
  UntrustedClientsFileLimit& operator=(const UntrustedClientsFileLimit&) = delete;

 private:
  rlimit before_{};
  void (*signal_)(int) = nullptr;
};

TEST_F(Mcap, AFullDiskLosesChunksAndKeepsTheFile) {
  const auto messages = drawMessages(12, 100, 2000);
  const std::string file = (folder_ / "full.mcap").string();
  McapWriter writer(file, threeChannels());
  std::vector<Kept> kept;
  {
    const UntrustedClientsFileLimit limit(60'000);
    for (std::size_t i = 0; i < messages.size(); ++i) {
      writeAll(writer, {messages[i]});
      writer.flush();
      if (writer.written() > kept.size()) kept.push_back(messages[i]);
    }
    EXPECT_EQ(writer.problem(), "File too large");
  }
  EXPECT_GT(writer.lost(), 30U);
  EXPECT_EQ(writer.written() + writer.lost(), messages.size());
  writer.finish();  // there is room again
  auto opened = McapReader::open(file);
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  McapReader reader = std::move(opened).value();
  EXPECT_EQ(readAll(reader), kept);
}

TEST_F(Mcap, TheRecorderWritesInOrderAndCountsItsLosses) {
  const SteadyClock clock;
  const auto messages = drawMessages(13, 2000, 500);
  const std::string file = (folder_ / "recorded.mcap").string();
  {
    Recorder recorder(
        file, threeChannels(), [](const std::string& line) { FAIL() << line; }, clock);
    for (const Kept& each : messages)
      recorder.push(each.channel - std::size_t{1}, each.time_ns, each.data);
  }
  auto opened = McapReader::open(file);
  ASSERT_TRUE(opened.ok());
  McapReader reader = std::move(opened).value();
  EXPECT_EQ(readAll(reader), messages);

  const std::string flood = (folder_ / "flood.mcap").string();
  std::uint64_t lost = 0;
  const int pushed = 64;
  const Bytes large(1U << 20U, 1);
  {
    Recorder recorder(
        flood, threeChannels(), [](const std::string&) {}, clock);
    for (int i = 0; i < pushed; ++i) recorder.push(0, static_cast<std::uint64_t>(i), large);
    lost = recorder.lost();
  }
  EXPECT_GT(lost, 0U) << "64 MiB do not wait in memory";
  opened = McapReader::open(flood);
  ASSERT_TRUE(opened.ok());
  McapReader kept = std::move(opened).value();
  EXPECT_EQ(readAll(kept).size() + lost, static_cast<std::size_t>(pushed));
}

}  // namespace
}  // namespace hapticast
