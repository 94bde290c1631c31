// SPDX-License-Identifier: MIT
// The depth of a whole clip in one array: NPY, and NPZ stored and deflated. Read in any order, cut,
// damaged, with wrong headers, beside a folder of colour images, and as NumPy writes it.
#include "server/source/picture/npy_stack.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <vector>

#include "server/source/folder/image_sequence.hpp"
#include "tests/support/installed.hpp"
#include "tests/unit/server/number_files.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::HasSubstr;

constexpr int kStackCount = 5;
const cv::Size kStackSize{32, 24};

/// Depth of frame `index`: every frame is another one.
cv::Mat stackPicture_mm(int index) {
  cv::Mat depth(kStackSize, CV_16UC1);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(500 + 100 * index + 30 * v + u);
  return depth;
}

/// Returns the frames as an NPY file with values of `type`, in mm or in metres.
std::string stackFile(const std::string& type = "<u2") {
  std::string content;
  for (int i = 0; i < kStackCount; ++i) {
    cv::Mat picture = stackPicture_mm(i);
    if (type == "|u1") picture.convertTo(picture, CV_8U, 0.1);
    if (type == "<f2") picture.convertTo(picture, CV_16F, 1e-3);
    if (type == "<f4") picture.convertTo(picture, CV_32F, 1e-3);
    if (type == "<f8") picture.convertTo(picture, CV_64F, 1e-3);
    content += toBytes(picture);
  }
  return npyFile(type, std::to_string(kStackCount) + ", 24, 32", content);
}

class NpyStackFile : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < kStackCount; ++i)
      folder.write("rgb/" + std::to_string(i) + ".png",
                   cv::Mat(kStackSize, CV_8UC3, cv::Scalar::all(90)));
  }
  [[nodiscard]] std::string stackError(const std::string& name, const std::string& bytes) const {
    return errorOf([&] { NpyStack stack(folder.write(name, bytes)); });
  }
  /// Requires the next picture to be frame `index`.
  static void expectNext(NpyStack& stack, int index) {
    const auto picture = stack.next();
    ASSERT_TRUE(picture) << index;
    ASSERT_TRUE(picture->ok()) << picture->problem;
    EXPECT_EQ(cv::norm(picture->image, stackPicture_mm(index), cv::NORM_INF), 0.0) << index;
  }
  SourceFolder folder;
};

TEST_F(NpyStackFile, EachFormAndOrderIsRead) {
  for (const std::string name : {"a.npy", "stored.npz", "deflated.npz"}) {
    const int method = name == "stored.npz" ? 0 : 8;
    folder.write(name, name == "a.npy" ? stackFile() : npzFile({{"d.npy", stackFile(), method}}));
    NpyStack stack(folder / name);
    EXPECT_EQ(stack.count(), 5U);
    EXPECT_EQ(stack.size(), kStackSize);
    EXPECT_EQ(stack.seeksBackwards(), name != "deflated.npz");
    for (int round = 0; round < 2; ++round) {
      expectNext(stack, 0);
      EXPECT_TRUE(stack.skip());
      expectNext(stack, 2);
      expectNext(stack, 3);
      expectNext(stack, 4);
      EXPECT_FALSE(stack.next());
      EXPECT_FALSE(stack.skip());
      stack.rewind();
    }
    for (const int index : {4, 3, 0, 2}) {
      stack.seek(static_cast<std::uint64_t>(index));
      expectNext(stack, index);
    }
  }
}

TEST_F(NpyStackFile, OfSeveralArraysTheNameCounts) {
  folder.write("several.npz", npzFile({{"images.npy", "x"},
                                       {"depth.npy", "x"},
                                       {"depths.npy", stackFile()},
                                       {"cam_c2w.npy", "x"}}));
  NpyStack stack(folder / "several.npz");
  expectNext(stack, 0);
}

TEST_F(NpyStackFile, WrongFilesAreNamed) {
  const std::string good = stackFile();
  EXPECT_THAT(stackError("a.npy", good.substr(0, good.size() - 1)),
              HasSubstr("a.npy: is cut off (it has 4 of 5 pictures)"));
  EXPECT_THAT(stackError("a.npy", good.substr(0, 20)), HasSubstr("is not a whole NPY array"));
  EXPECT_THAT(stackError("a.npy", "x"), HasSubstr("is not a whole NPY array"));
  EXPECT_THAT(stackError("a.npy", npyFile("<u2", "24, 32", std::string(4000, 'x'))),
              HasSubstr("has the shape (24, 32), not (frames, height, width)"));
  EXPECT_THAT(stackError("a.npy", npyFile("<u2", "5, 24, 32", "", 1, "True")),
              HasSubstr("is in the order of Fortran"));
  EXPECT_THAT(stackError("a.npy", npyFile("<i8", "5, 24, 32", "")), HasSubstr("type '<i8'"));
  EXPECT_THAT(stackError("a.npy", npyFile("<f8", "5, 9000, 9000", "")),
              HasSubstr("is 9000x9000, larger than"));
  EXPECT_THAT(stackError("a.npy", npyFile("<f8", "999999999, 4320, 8192", "")),
              HasSubstr("has the shape (999999999, 4320, 8192), not (frames, height, width)"));
  EXPECT_THAT(stackError("a.npy", npyFile("<f8", "9999999, 4320, 8192", "")),
              HasSubstr("(it has 0 of 9999999 pictures)"));
  EXPECT_THAT(stackError("a.npy", npyFile("<f8", "99999999999999999999, 4, 4", "")),
              HasSubstr("not (frames, height, width)"));
  EXPECT_THAT(errorOf([&] { NpyStack stack(folder / "none.npz"); }), HasSubstr("cannot be read"));
}

TEST_F(NpyStackFile, WrongArchivesAreNamed) {
  EXPECT_THAT(stackError("a.npz", stackFile()), HasSubstr("a.npz: is not an NPZ file"));
  const std::string archive = npzFile({{"d.npy", stackFile()}});
  EXPECT_THAT(stackError("a.npz", archive.substr(0, archive.size() / 2)),
              HasSubstr("is cut off or damaged"));
  EXPECT_THAT(stackError("a.npz", npzFile({{"d.npy", stackFile(), 12}})),
              HasSubstr("is compressed in another way"));
  EXPECT_THAT(stackError("a.npz", npzFile({{"d.npy", stackFile().substr(0, 5000)}})),
              HasSubstr("is cut off (it has 3 of 5 pictures)"));
}

TEST_F(NpyStackFile, ADamagedArchiveKeepsItsFirstPictures) {
  std::string archive = npzFile({{"d.npy", stackFile()}});
  archive[5000] = static_cast<char>(archive[5000] + 1);  // in frame 3: the sum of all bytes fails
  NpyStack sum(folder.write("sum.npz", archive));
  std::fill_n(archive.begin() + 4000, 1100, '\x7F');  // in frames 2 and 3: no deflate stream
  NpyStack broken(folder.write("broken.npz", archive));
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < kStackCount; ++i) EXPECT_EQ(sum.next()->ok(), i < 4) << i;
    for (int i = 0; i < kStackCount; ++i) EXPECT_EQ(broken.next()->ok(), i < 2) << i;
    sum.rewind();
    broken.rewind();
  }
}

TEST_F(NpyStackFile, AFolderOfColoursHasItsDepth) {
  for (const std::string type : {"<u2", "<f2", "<f4", "<f8"}) {
    folder.write("depths.npz", npzFile({{"depths.npy", stackFile(type)}}));
    ImageSequence source(folder.string(), 0.0);
    EXPECT_EQ(source.info().depth_kind, DepthKind::kMetric);
    EXPECT_EQ(source.info().frame_count, 5U);
    source.skip();
    for (int i = 1; i < kStackCount; ++i) {
      const auto frame = source.read();
      ASSERT_TRUE(frame) << type;
      cv::Mat truth;
      stackPicture_mm(i).convertTo(truth, CV_32F);
      EXPECT_LE(cv::norm(frame->depth, truth, cv::NORM_INF), type == "<f2" ? 1.0 : 1e-3) << type;
    }
    EXPECT_FALSE(source.read());
  }
  folder.write("depth.npy", stackFile("|u1"));
  EXPECT_EQ(ImageSequence(folder.string(), 0.0).info().depth_kind, DepthKind::kHeight);
}

TEST_F(NpyStackFile, AFolderPlaysToAndFroUnlessItsDepthIsCompressed) {
  folder.write("depth.npz", npzFile({{"d.npy", stackFile(), 0}}));
  ImageSequence source(folder.string(), 0.0, true);
  std::vector<float> depths_mm;
  while (const auto frame = source.read()) depths_mm.push_back(frame->depth.at<float>(0, 0));
  EXPECT_EQ(depths_mm, (std::vector<float>{500, 600, 700, 800, 900, 800, 700, 600}));
  folder.write("depth.npz", npzFile({{"d.npy", stackFile(), 8}}));
  EXPECT_THAT(errorOf([this] { ImageSequence(folder.string(), 0.0, true); }),
              HasSubstr("depth.npz: is compressed, so it cannot play --to-and-fro"));
}

TEST_F(NpyStackFile, AColourVideoHasItsDepth) {
  if (!isInstalled("ffmpeg")) GTEST_SKIP() << "needs ffmpeg";
  folder.ffmpeg("-r 20 -i rgb/%d.png -c:v ffv1 -pix_fmt bgr0 c.mkv");
  const std::string spec = (folder / "c.mkv").string() + "," + (folder / "depths.npz").string();
  EXPECT_THAT(openError(spec), HasSubstr("depths.npz: cannot be read"));
  folder.write("depths.npz", npzFile({{"depths.npy", stackFile("<f4")}}));
  const auto source = openSource(spec, 0.0);
  EXPECT_EQ(source->info().depth_kind, DepthKind::kMetric);
  EXPECT_EQ(source->info().frame_count, 5U);
  EXPECT_NEAR(source->info().fps, 20.0, 0.01);
  for (int round = 0; round < 2; ++round) {
    EXPECT_TRUE(source->skip());
    for (int i = 1; i < kStackCount; ++i) {
      const auto frame = source->read();
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->index, static_cast<std::uint64_t>(i));
      cv::Mat truth;
      stackPicture_mm(i).convertTo(truth, CV_32F);
      EXPECT_LE(cv::norm(frame->depth, truth, cv::NORM_INF), 1e-3);
    }
    EXPECT_FALSE(source->read());
    source->rewind();
  }
  const auto flagError = [&](DepthCode code) {
    return errorOf([&] { (void)openSource(spec, 0.0, false, {Layout::kSeparate, code}); });
  };
  EXPECT_THAT(flagError(DepthCode::kHue), HasSubstr("is an array, which has no hues"));
  EXPECT_THAT(flagError(DepthCode::kInverse), HasSubstr("has depth in mm"));
}

TEST_F(NpyStackFile, AFolderWithAnotherNumberOfColoursIsRefused) {
  folder.write("depth.npy", stackFile());
  std::filesystem::remove(folder / "rgb/4.png");
  EXPECT_THAT(openError(folder.string()), HasSubstr("depth.npy: 5 images, but there are 4 colour"));
}

TEST_F(NpyStackFile, WhatNumPyWritesIsRead) {
  std::string line = "cd '" + folder.string() +
                     "' && python3 -c \"import numpy as np; v, u = np.mgrid[0:24, 0:32]; d = "
                     "np.stack([500 + 100 * i + 30 * v + u for i in range(5)]).astype('u2'); "
                     "np.save('a.npy', d); np.savez('b.npz', d); np.savez_compressed('c.npz', "
                     "cam=np.eye(3), depths=d)\" 2>/dev/null";
  if (std::system(line.c_str()) != 0) GTEST_SKIP() << "needs python3-numpy";
  for (const char* name : {"a.npy", "b.npz", "c.npz"}) {
    NpyStack stack(folder / name);
    for (int i = 0; i < kStackCount; ++i) expectNext(stack, i);
    EXPECT_FALSE(stack.next());
  }
}

}  // namespace
}  // namespace hapticast::server
