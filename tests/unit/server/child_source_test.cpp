// SPDX-License-Identifier: MIT
// Depth and masks from programs of the user: real children of the shell and of Python.
#include "server/source/child/child_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/source/child/depth_task.hpp"
#include "server/source/child/mask_task.hpp"
#include "tests/scenes/drawn_source.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/support/waiting.hpp"

namespace hapticast::server {
namespace {

using test::FunctionSource;
using ::testing::HasSubstr;

constexpr int kChildWidth_px = 8;
constexpr int kChildHeight_px = 6;

/// Colour frames without depth: the blue value is the number of the frame.
std::unique_ptr<RgbdSource> makeColors(std::uint64_t frames) {
  SourceInfo info;
  info.name = "colours";
  info.width_px = kChildWidth_px;
  info.height_px = kChildHeight_px;
  return std::make_unique<FunctionSource>(info, frames, [](std::uint64_t index) {
    RgbdFrame frame;
    frame.color =
        cv::Mat(kChildHeight_px, kChildWidth_px, CV_8UC3, cv::Scalar(double(index), 20, 30));
    frame.depth = cv::Mat(kChildHeight_px, kChildWidth_px, CV_32FC1, cv::Scalar(500.0));
    return frame;
  });
}

/// A child that answers 1000 + the blue value of each picture, after `body` in each round. `late`:
/// it answers so many pictures later.
std::string depthChild(const TempFolder& folder, const std::string& body, int late = 0) {
  const std::string script = R"(
import array, os, sys, time
waiting = []
number = 0
while sys.stdin.buffer.readline():
    width, height = map(int, sys.stdin.buffer.readline().split())
    sys.stdin.buffer.readline()
    rgb = sys.stdin.buffer.read(3 * width * height)
    assert rgb[0] == 30 and rgb[1] == 20
    waiting.append(1000.0 + rgb[2])
    kind = "metric_mm"
)" + body + R"(
    number += 1
    if len(waiting) > )" + std::to_string(late) +
                             R"(:
        depth = array.array("f", [waiting.pop(0)]) * (width * height)
        sys.stdout.buffer.write(f"{width} {height} {kind}\n".encode() + depth.tobytes())
        sys.stdout.buffer.flush()
)";
  return "exec /usr/bin/env python3 '" + folder.write("child.py", script) + "'";
}

std::unique_ptr<ChildSource> openDepth(const std::string& command, std::uint64_t frames,
                                       std::unique_ptr<DepthCache> cache = nullptr) {
  return std::make_unique<ChildSource>(
      makeColors(frames), std::make_unique<DepthTask>(command, kRelativeRange, std::move(cache)),
      nullptr);
}

void expectAllFrames(RgbdSource& source, std::uint64_t frames) {
  for (std::uint64_t i = 0; i < frames; ++i) {
    const auto frame = source.read();
    ASSERT_TRUE(frame) << i;
    EXPECT_EQ(frame->index, i);
    EXPECT_EQ(frame->depth.at<float>(3, 4), 1000.0F + float(i));
  }
  EXPECT_FALSE(source.read());
}

std::string describeProblem(const std::string& command) {
  try {
    (void)openDepth(command, 3);
  } catch (const SourceError& error) {
    return error.what();
  }
  return "";
}

TEST(ChildSource, EachFrameHasItsOwnDepthInEachPass) {
  const TempFolder folder;
  const auto source = openDepth(depthChild(folder, ""), 30);
  EXPECT_EQ(source->info().estimated, EstimatedDepth::kMetric);
  expectAllFrames(*source, 30);
  source->rewind();
  ASSERT_TRUE(source->read());
  source->rewind();  // frames in flight are of the pass before
  expectAllFrames(*source, 30);
  source->rewind();
  ASSERT_TRUE(source->skip());
  EXPECT_EQ(source->read()->index, 1U);
}

TEST(ChildSource, AChildThatAnswersTwoPicturesLaterAnswersTheLastFramesToo) {
  const TempFolder folder;
  const auto source = openDepth(depthChild(folder, "", 2), 12);
  expectAllFrames(*source, 12);
  source->rewind();
  expectAllFrames(*source, 12);
}

TEST(ChildSource, AChildThatDiesLosesNoFrame) {
  const TempFolder folder;
  const std::string dies = "    if number == 9: os._exit(3)\n";
  expectAllFrames(*openDepth(depthChild(folder, dies), 20), 20);
}

TEST(ChildSource, ASlowReaderGetsEachFrameAfterItsChildDied) {
  const TempFolder folder;
  const std::string dies =
      "    if rgb[2] == 4 and not os.path.exists(sys.argv[0] + '.once'):\n"
      "        open(sys.argv[0] + '.once', 'w').close()\n"
      "        os._exit(3)\n";
  const auto source = openDepth(depthChild(folder, dies), 20);
  for (std::uint64_t i = 0; i < 20; ++i) {
    // The pause before the next child (1 s) is over when the frames are read.
    if (i == 2) restBetweenTurns(std::chrono::milliseconds(1500));
    const auto frame = source->read();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
    EXPECT_EQ(frame->depth.at<float>(3, 4), 1000.0F + float(i));
  }
}

TEST(ChildSource, AChildThatAlwaysDiesEndsTheClip) {
  const TempFolder folder;
  const std::string dies = "    if rgb[2] == 9: os._exit(3)\n";
  const auto source = openDepth(depthChild(folder, dies), 20);
  try {
    while (source->read()) {
    }
    ADD_FAILURE() << "no error";
  } catch (const SourceError& error) {
    EXPECT_THAT(error.what(), HasSubstr("ended with exit code 3; mend the command"));
  }
}

/// A live source of 200 frames/s whose frames are new.
class LiveColors final : public RgbdSource {
 public:
  LiveColors() : info_(makeColors(1)->info()) { info_.live = true; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  std::optional<RgbdFrame> read() override {
    restBetweenTurns(std::chrono::milliseconds(5));
    RgbdFrame frame;
    frame.index = next_++;
    frame.clip_time_s = double(frame.index) / 200.0;
    frame.color = cv::Mat(kChildHeight_px, kChildWidth_px, CV_8UC3,
                          cv::Scalar(double(frame.index % 200), 20, 30));
    return frame;
  }
  bool skip() override { return read().has_value(); }
  void rewind() override {}

 private:
  SourceInfo info_;
  std::uint64_t next_ = 0;
};

TEST(ChildSource, ALiveSourceGoesOnInANewEpochAfterItsChildDied) {
  const TempFolder folder;
  const std::string dies = "    if number == 9: os._exit(3)\n";
  for (const int late : {0, 2}) {
    ChildSource source(
        std::make_unique<LiveColors>(),
        std::make_unique<DepthTask>(depthChild(folder, dies, late), kRelativeRange, nullptr),
        nullptr);
    std::uint32_t epoch = 0;
    EXPECT_TRUE(waitUntil(std::chrono::seconds(60), [&] {
      const auto frame = source.read();
      if (!frame) return false;
      EXPECT_EQ(frame->depth.at<float>(1, 1), 1000.0F + float(frame->index % 200));
      EXPECT_LT(frame->age, std::chrono::seconds(1));
      epoch = frame->epoch;
      EXPECT_TRUE(epoch == 0 || frame->clip_time_s < 0.5);
      return epoch > 0;
    }));
    EXPECT_EQ(epoch, 1U) << late;
  }
}

TEST(ChildSource, AWrongSizeLeavesItsFrameOut) {
  const TempFolder folder;
  const std::string wrong = "    if rgb[2] == 4: height = 1\n";
  const auto source = openDepth(depthChild(folder, wrong), 8);
  std::vector<std::uint64_t> indices;
  while (const auto frame = source->read()) indices.push_back(frame->index);
  EXPECT_EQ(indices, (std::vector<std::uint64_t>{0, 1, 2, 3, 5, 6, 7}));
}

TEST(ChildSource, AWrongCommandIsOneLine) {
  EXPECT_THAT(describeProblem("exit 4;"),
              HasSubstr("--depth-from 'exit 4;': ended with exit code 4"));
  EXPECT_THAT(describeProblem("echo oh no >&2; exit 1"), HasSubstr("exit code 1: oh no; mend"));
  EXPECT_THAT(describeProblem("echo hello"), HasSubstr("writes 'hello', which is no header"));
  EXPECT_THAT(describeProblem("yes | tr -d '\\n'"), HasSubstr("writes no line with a header"));
  EXPECT_THAT(describeProblem("echo 4097 4 metric_mm"), HasSubstr("no header"));
  EXPECT_THAT(describeProblem("exec >&-; kill -STOP $$"), HasSubstr("closes its stdout"));
  EXPECT_THAT(describeProblem("printf '1 4 inverse\\n%16s'"), HasSubstr("another shape"));
  EXPECT_THAT(describeProblem("command false"), HasSubstr("ended with exit code 1"));
}

TEST(ChildSource, AnswersBeyondThePicturesEndTheChild) {
  ChildPipe pipe("printf '0 0\\n0 0\\n'; kill -STOP $$",
                 [](const std::string&) { return std::optional<std::size_t>(0); });
  EXPECT_FALSE(pipe.pop(std::chrono::seconds(60)));
  EXPECT_EQ(pipe.problem(), "writes more answers than it received pictures");
}

TEST(ChildSource, ACacheSparesTheChild) {
  const TempFolder folder;
  const std::string clip = "a clip";
  const auto cache = [&](double limit_GB = 1.0) {
    return std::make_unique<DepthCache>(folder / "cache", limit_GB, clip);
  };
  expectAllFrames(*openDepth(depthChild(folder, ""), 9, cache()), 9);
  expectAllFrames(*openDepth("false", 9, cache()), 9);
  for (const auto& file : std::filesystem::recursive_directory_iterator(folder / "cache")) {
    if (file.path().filename() == "000004.depth") folder.write(file.path().string(), "damaged");
  }
  expectAllFrames(*openDepth(depthChild(folder, ""), 9, cache()), 9);
}

TEST(DepthCache, AFullCacheForgetsOtherClipsButNothingElse) {
  const TempFolder folder;
  const ChildAnswer answer{"8 6 metric_mm", std::vector<std::uint8_t>(192, 7)};
  constexpr double kLimit_GB = 200e-9;  // some 60 bytes for each frame
  std::filesystem::create_directories(folder / "mine");
  folder.write("mine/file.depth", "of somebody else");
  DepthCache first(folder / ".", kLimit_GB, "first");
  first.store(0, answer);
  ASSERT_TRUE(first.load(0));
  DepthCache second(folder / ".", kLimit_GB, "second");
  for (std::uint64_t i = 0; i < 20; ++i) second.store(i, answer);
  EXPECT_FALSE(first.load(0));
  EXPECT_TRUE(second.load(0));
  EXPECT_EQ(second.load(0)->bytes, answer.bytes);
  EXPECT_FALSE(second.load(19));
  EXPECT_TRUE(std::filesystem::exists(folder / "mine" / "file.depth"));
}

TEST(DepthTask, HeadersAreChecked) {
  EXPECT_EQ(parseDepthHeader("640 480 inverse"), (DepthHeader{640, 480, EstimatedDepth::kInverse}));
  for (const char* line : {"", "640 480", "640 480 metres", "0 480 relative", "-1 4 relative",
                           "640 480 relative 3", "99999999999 4 relative", "4 4097 relative"})
    EXPECT_FALSE(parseDepthHeader(line)) << line;
}

TEST(DepthTask, InvalidDepthBecomesZero) {
  DepthTask task("", kRelativeRange, nullptr);
  std::vector<float> values(48, 700.0F);
  values[0] = NAN;
  values[1] = INFINITY;
  values[2] = -5.0F;
  values[3] = 1e38F;
  std::vector<std::uint8_t> bytes(4 * values.size());
  std::memcpy(bytes.data(), values.data(), bytes.size());
  auto frame = makeColors(1)->read();
  EXPECT_EQ(task.apply(*frame, {"8 6 metric_mm", bytes}), "");
  for (int i = 0; i < 4; ++i) EXPECT_EQ(frame->depth.at<float>(0, i), 0.0F);
  EXPECT_EQ(frame->depth.at<float>(0, 4), 700.0F);
}

TEST(DepthTask, RelativeDepthFillsItsRange) {
  cv::RNG random(3);
  cv::Mat depth(60, 80, CV_32FC1);
  random.fill(depth, cv::RNG::UNIFORM, 700.0, 1500.0);
  for (const double scale : {0.001, 2.0}) {
    for (const double shift : {-5.0, 40.0}) {
      const cv::Mat values = depth * scale + shift;
      const cv::Mat same =
          RelativeDepthMap(values, EstimatedDepth::kRelative, {716, 1484}).convert(values);
      EXPECT_LT(cv::norm(same, depth, cv::NORM_INF), 12.0);
      const cv::Mat inverse = 1000.0 / depth * scale + shift;
      const cv::Mat back =
          RelativeDepthMap(inverse, EstimatedDepth::kInverse, {716, 1484}).convert(inverse);
      EXPECT_LT(cv::norm(back, depth, cv::NORM_INF), 12.0);
    }
  }
  depth.at<float>(3, 4) = NAN;
  const RelativeDepthMap map(depth, EstimatedDepth::kInverse, {600, 1200});
  EXPECT_EQ(map.convert(depth).at<float>(3, 4), 0.0F);
  EXPECT_TRUE(cv::checkRange(map.convert(depth), true, nullptr, 0.0, 12001.0));
}

std::unique_ptr<MaskTask> makeMaskTask(const std::string& command) {
  return std::make_unique<MaskTask>(command, std::vector<MaskPoint>{{{3.5, 2.0}, 0.0, 1}}, nullptr);
}

TEST(MaskTask, ARequestHasPointsPictureAndDepth) {
  const auto frame = makeColors(1)->read();
  const auto bytes = encodeMaskRequest(*frame, {{{3.5, 2.0}, 0.0, 1}, {{1.0, 1.0}, 9.0, 0}});
  const std::string line(bytes.begin(), std::find(bytes.begin(), bytes.end(), '\n'));
  EXPECT_EQ(line, R"({"frame":0,"height":6,"points":[{"object":1,"time_s":0.0,"u":3.5,"v":2.0}],)"
                  R"("time_s":0.0,"width":8})");
  ASSERT_EQ(bytes.size(), line.size() + 1 + std::size_t{48} * 7);
  EXPECT_EQ(bytes[line.size() + 1], 30);
  float last_mm = 0.0F;
  std::memcpy(&last_mm, bytes.data() + bytes.size() - 4, 4);
  EXPECT_EQ(last_mm, 500.0F);
}

TEST(MaskTask, AnswersBecomeKeyMasksAndAnEmptyOneIsNone) {
  const TempFolder folder;
  const std::string script = folder.write("masks.py", R"(
import json, sys
while line := sys.stdin.buffer.readline():
    request = json.loads(line)
    size = request["width"] * request["height"]
    assert len(sys.stdin.buffer.read(7 * size)) == 7 * size
    if request["frame"] % 2 == 1:
        answer = b"0 0\n"
    else:
        answer = b"8 6\n" + bytes([request["points"][0]["object"]] * 24 + [0] * 24)
    sys.stdout.buffer.write(answer)
    sys.stdout.buffer.flush()
)");
  ChildSource source(makeColors(4), makeMaskTask("exec /usr/bin/env python3 '" + script + "'"),
                     nullptr);
  EXPECT_TRUE(source.info().key_masks);
  for (int pass = 0; pass < 2; ++pass) {
    for (std::uint64_t i = 0; i < 4; ++i) {
      const auto frame = source.read();
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->mask.empty(), i % 2 == 1);
      if (i % 2 == 0) {
        EXPECT_EQ(cv::countNonZero(frame->mask == 1), 24);
      }
    }
    EXPECT_FALSE(source.read());
    source.rewind();
  }
}

TEST(MaskTask, AProgramThatBeginsToAnswerWronglyCostsNoFrame) {
  const TempFolder folder;
  const std::string script = folder.write("masks.py", R"(
import json, sys
while line := sys.stdin.buffer.readline():
    request = json.loads(line)
    sys.stdin.buffer.read(7 * request["width"] * request["height"])
    sys.stdout.buffer.write(b"8 6\n" + bytes([1] * 48) if request["frame"] < 2 else b"4 3\n" + bytes(12))
    sys.stdout.buffer.flush()
)");
  ChildSource source(makeColors(6), makeMaskTask("/usr/bin/env python3 '" + script + "'"), nullptr);
  for (std::uint64_t i = 0; i < 6; ++i) {
    const auto frame = source.read();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
    EXPECT_EQ(frame->mask.empty(), i >= 2);
  }
  EXPECT_FALSE(source.read());
}

TEST(MaskTask, WrongMasksLeaveTheFrameWithoutOne) {
  MaskTask task("", {}, nullptr);
  auto frame = makeColors(1)->read();
  EXPECT_THAT(task.apply(*frame, {"6 8", std::vector<std::uint8_t>(48, 1)}),
              HasSubstr("a mask of 6x8 for a picture of 8x6"));
  EXPECT_THAT(task.apply(*frame, {"8 6", std::vector<std::uint8_t>(48, 17)}),
              HasSubstr("the value 17"));
  EXPECT_TRUE(frame->mask.empty());
  EXPECT_EQ(task.measure("8 6"), std::optional<std::size_t>(48));
  for (const char* line : {"", "8", "8 0", "-8 6", "8 6 1", "5000 6"})
    EXPECT_FALSE(task.measure(line)) << line;
}

TEST(MaskFolder, KeepsTheMasksOfOneCommandAndTheAuthorsOwn) {
  const TempFolder folder;
  const std::vector<std::uint8_t> png{1, 2, 3};
  {
    MaskFolder masks(folder / ".", {"a", "b"}, "command");
    masks.store(0, png);
    EXPECT_FALSE(masks.isComplete());
    masks.store(1, {});
    EXPECT_TRUE(masks.isComplete());
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "mask" / "a.png"));
  EXPECT_FALSE(std::filesystem::exists(folder / "mask" / "b.png"));
  EXPECT_TRUE(MaskFolder(folder / ".", {"a", "b"}, "command").isComplete());
  EXPECT_THROW(MaskFolder(folder / ".", {"a", "b"}, "another"), SourceError);
  std::filesystem::remove(folder / "mask" / "mask-from.txt");
  EXPECT_THROW(MaskFolder(folder / ".", {"a", "b"}, "command"), SourceError);
}

}  // namespace
}  // namespace hapticast::server
