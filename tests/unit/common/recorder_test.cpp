// SPDX-License-Identifier: MIT
// The recorder beside a slow disk: its end has a deadline, and its text has the number of losses.
#include "common/recording/recorder.hpp"

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "tests/unit/common/mcap_fixture.hpp"

namespace hapticast {
namespace {

/// The clock of a recorder whose disk needs `write_time` for each write: the file has grown then.
/// The first write ends after the owner, who made this clock, has asked for the time in finish().
class SlowDiskClock final : public Clock {
 public:
  SlowDiskClock(std::string file, Duration write_time)
      : file_(std::move(file)), write_time_(write_time) {}

  [[nodiscard]] LocalTime now() const noexcept override {
    if (std::this_thread::get_id() == owner_) {
      const LocalTime now = now_;
      ended_ = true;
      ended_.notify_all();
      return now;
    }
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file_, error);
    if (size > size_.value_or(size)) {
      writes_ = true;
      writes_.notify_all();
      ended_.wait(false);
      now_ = now_.load() + write_time_;
    }
    size_ = size;
    return now_;
  }
  /// Waits until the first write runs.
  void waitForWrite() const { writes_.wait(false); }

 private:
  const std::string file_;
  const Duration write_time_;
  const std::thread::id owner_ = std::this_thread::get_id();
  mutable std::atomic<LocalTime> now_{LocalTime{}};
  mutable std::atomic<bool> writes_{false}, ended_{false};
  mutable std::optional<std::uintmax_t> size_;  // used by the recorder's thread only
};

class RecorderTest : public McapFilesTest {
 protected:
  static constexpr std::size_t kPushed = 10;

  /// Ends a recorder while the first of ten messages is written; each message is a chunk. Returns
  /// the text of finish().
  std::string finishDuringWrite(Duration write_time) {
    std::filesystem::remove(file_);
    const SlowDiskClock clock(file_, write_time);
    Recorder recorder(
        file_, threeChannels(), [](const std::string& line) { FAIL() << line; }, clock);
    for (const Kept& each : messages_) recorder.push(0, each.time_ns, each.data);
    clock.waitForWrite();
    std::string text = recorder.finish();
    lost_ = recorder.lost();
    is_complete_ = recorder.isComplete();
    took_ = clock.now() - LocalTime{};
    return text;
  }

  std::vector<Kept> readFile() const {
    auto opened = McapReader::open(file_);
    EXPECT_TRUE(opened.ok());
    McapReader reader = std::move(opened).value();
    return readAll(reader);
  }

  const std::string file_ = (folder_ / "slow.mcap").string();
  const std::vector<Kept> messages_ = [] {
    std::vector<Kept> messages;
    for (std::size_t i = 0; i < kPushed; ++i)
      messages.push_back({1, 1000 + i, Bytes(McapWriter::kChunkBytes, 1)});
    return messages;
  }();
  std::uint64_t lost_ = 0;
  bool is_complete_ = false;
  Duration took_{};
};

TEST_F(RecorderTest, ASlowDiskEndsWithinTheDeadlineAndTheTextHasTheLosses) {
  // Seconds of a write, and how many are done: the one that runs, then those that fit in 6 s.
  const std::vector<std::pair<double, std::size_t>> cases{{7.0, 1}, {5.0, 2}, {2.0, 4}, {1.0, 7}};
  for (const auto& [write_s, written] : cases) {
    const std::string text = finishDuringWrite(fromSeconds(write_s));
    EXPECT_EQ(lost_, kPushed - written) << write_s;
    EXPECT_EQ(text, "lacks " + std::to_string(lost_) + " messages (the disk is too slow)");
    EXPECT_FALSE(is_complete_);
    EXPECT_LE(took_, fromSeconds(write_s) + Recorder::kFinishWithin);
    const auto read = readFile();
    EXPECT_EQ(read.size(), written);
    expectPrefix(read, messages_);
  }
}

TEST_F(RecorderTest, ADiskThatIsQuickEnoughLosesNothing) {
  EXPECT_EQ(finishDuringWrite(fromSeconds(0.5)), "is complete");
  EXPECT_TRUE(is_complete_);
  EXPECT_EQ(readFile(), messages_);
  // All messages fit, the index does not.
  EXPECT_EQ(finishDuringWrite(fromSeconds(0.66)),
            "has no index (the disk is too slow), but can be read");
  EXPECT_FALSE(is_complete_);
  EXPECT_EQ(lost_, 0U);
  EXPECT_EQ(readFile(), messages_);
}

}  // namespace
}  // namespace hapticast
