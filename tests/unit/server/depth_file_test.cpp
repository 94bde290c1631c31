// SPDX-License-Identifier: MIT
// Depth in the formats that people have: TIFF, EXR, PGM, PFM, NPY, NPZ. Made by OpenCV and by hand,
// cut, with wrong headers, and as a clip with the usual names of folders and with gaps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <iterator>
#include <random>

#include "server/source/folder/image_sequence.hpp"
#include "tests/unit/server/number_files.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::HasSubstr;

constexpr int kWidth_px = 32;
constexpr int kHeight_px = 24;

/// A slope in mm, with every depth once.
cv::Mat slope_mm() {
  cv::Mat depth(kHeight_px, kWidth_px, CV_16UC1);
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u)
      depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(700 + 37 * v + u);
  return depth;
}

cv::Mat slope_m() {
  cv::Mat depth;
  slope_mm().convertTo(depth, CV_32F, 1e-3);
  return depth;
}

std::string npy(const std::string& type, const cv::Mat& matrix, int version = 1,
                const std::string& fortran = "False") {
  return npyFile(type, std::to_string(matrix.rows) + ", " + std::to_string(matrix.cols),
                 toBytes(matrix), version, fortran);
}

std::string npz(const std::string& type, const cv::Mat& matrix, int method) {
  return npzFile({{"arr_0.npy", npy(type, matrix), method}});
}

/// Returns a PFM file, whose lowest row is the first one.
std::string pfm(const cv::Mat& image, bool big_endian, const std::string& scale = "1.0") {
  std::string text = "Pf\n" + std::to_string(image.cols) + " " + std::to_string(image.rows) +
                     (big_endian ? "\n" : "\n-") + scale + "\n";
  for (int v = image.rows - 1; v >= 0; --v) {
    for (int u = 0; u < image.cols; ++u) {
      std::string bytes = littleEndian(std::bit_cast<std::uint32_t>(image.at<float>(v, u)), 4);
      if (big_endian) std::reverse(bytes.begin(), bytes.end());
      text += bytes;
    }
  }
  return text;
}

class DepthFile : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 3; ++i)
      folder.write("rgb/" + std::to_string(i) + ".png",
                   cv::Mat(kHeight_px, kWidth_px, CV_8UC3, cv::Scalar::all(100)));
    std::filesystem::create_directories(folder / "depth");
  }
  /// Writes the same image for each frame.
  void fill(const std::string& ending, const cv::Mat& image) const {
    for (int i = 0; i < 3; ++i) folder.write("depth/" + std::to_string(i) + ending, image);
  }
  void fill(const std::string& ending, const std::string& text) const {
    for (int i = 0; i < 3; ++i) folder.write("depth/" + std::to_string(i) + ending, text);
  }
  /// Largest difference of the source's depth from the slope, mm.
  [[nodiscard]] double error_mm() const {
    ImageSequence source(folder.string(), 0.0);
    EXPECT_EQ(source.info().depth_kind, DepthKind::kMetric);
    const auto frame = source.read();
    cv::Mat truth;
    slope_mm().convertTo(truth, CV_32F);
    return cv::norm(frame->depth, truth, cv::NORM_INF);
  }
  [[nodiscard]] std::string readBytes(const std::string& name) const {
    std::ifstream in(folder / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::string openError() const {
    return errorOf([this] { ImageSequence(folder.string(), 0.0); });
  }
  SourceFolder folder;
};

TEST_F(DepthFile, SixteenBitFilesAreMillimetresAndExact) {
  fill(".tif", slope_mm());
  EXPECT_EQ(error_mm(), 0.0);
  std::filesystem::remove_all(folder / "depth");
  fill(".pgm", slope_mm());
  EXPECT_EQ(error_mm(), 0.0);
  std::filesystem::remove_all(folder / "depth");
  std::filesystem::create_directories(folder / "depth");
  fill(".npy", npy("<u2", slope_mm()));
  EXPECT_EQ(error_mm(), 0.0);
}

TEST_F(DepthFile, FloatsAreMetres) {
  fill(".tiff", slope_m());
  EXPECT_LT(error_mm(), 1e-3);
  std::filesystem::remove_all(folder / "depth");
  fill(".exr", slope_m());
  EXPECT_LT(error_mm(), 1e-3);
  std::filesystem::remove_all(folder / "depth");
  std::filesystem::create_directories(folder / "depth");
  for (const int version : {1, 2, 3}) {
    fill(".npy", npy("<f4", slope_m(), version));
    EXPECT_LT(error_mm(), 1e-3);
  }
  cv::Mat precise;
  slope_m().convertTo(precise, CV_64F);
  fill(".npy", npy("<f8", precise));
  EXPECT_LT(error_mm(), 1e-3);
}

TEST_F(DepthFile, HalfFloatsAreMetres) {
  cv::Mat half;
  slope_m().convertTo(half, CV_16F);
  fill(".npy", npy("<f2", half));
  EXPECT_GT(error_mm(), 0.0) << "eleven bits are not exact";
  EXPECT_LT(error_mm(), 0.5);
}

TEST_F(DepthFile, PfmOfBothByteOrdersHasItsLowestRowFirst) {
  for (const bool big_endian : {false, true}) {
    for (const std::string scale : {"1.0", "0.003922"}) {  // Middlebury's
      fill(".pfm", pfm(slope_m(), big_endian, scale));
      EXPECT_LT(error_mm(), 1e-3) << big_endian << scale;
    }
  }
}

TEST_F(DepthFile, NpzWithOneMatrixIsRead) {
  for (const int method : {0, 8}) {
    fill(".npz", npz("<u2", slope_mm(), method));
    EXPECT_EQ(error_mm(), 0.0) << method;
    fill(".npz", npz("<f4", slope_m(), method));
    EXPECT_LT(error_mm(), 1e-3) << method;
  }
  fill(".npz", npzFile({{"focal.npy", "x"}, {"depth.npy", npy("<u2", slope_mm())}}));
  EXPECT_EQ(error_mm(), 0.0) << "of several arrays the one with the name";
}

TEST_F(DepthFile, OtherFormatsCountOnlyWithoutTheUsualOnes) {
  fill(".npy", npy("<u2", slope_mm()));
  fill(".npz", std::string("x"));
  fill(".pfm", std::string("x"));
  folder.write("rgb/0.bmp", std::string("x"));
  EXPECT_EQ(error_mm(), 0.0);
}

TEST_F(DepthFile, AScaleOfTheAuthorCountsForFloatsToo) {
  cv::Mat cm;
  slope_mm().convertTo(cm, CV_32F, 0.1);
  fill(".npy", npy("<f4", cm));
  folder.write("meta.json", std::string(R"({"depth_scale_m_per_unit": 0.01})"));
  EXPECT_LT(error_mm(), 1e-2);
}

TEST_F(DepthFile, AMissingDepthIsZero) {
  cv::Mat depth = slope_m();
  depth.at<float>(0, 0) = std::numeric_limits<float>::quiet_NaN();
  depth.at<float>(0, 1) = std::numeric_limits<float>::infinity();
  depth.at<float>(0, 2) = -1.0F;
  fill(".npy", npy("<f4", depth));
  ImageSequence source(folder.string(), 0.0);
  const auto frame = source.read();
  for (int u = 0; u < 3; ++u) EXPECT_EQ(frame->depth.at<float>(0, u), 0.0F);
  EXPECT_GT(frame->depth.at<float>(0, 3), 0.0F);
}

TEST_F(DepthFile, WrongHeadersAreNamed) {
  const auto error = [this](const std::string& text) {
    fill(".npy", text);
    return openError();
  };
  EXPECT_THAT(error(npy("<i8", slope_mm())),
              HasSubstr("has values of the type '<i8', not |u1, <u2, <f2, <f4 or <f8; convert it "
                        "(numpy: a.astype(np.uint16), in mm)"));
  EXPECT_THAT(error(npy(">f4", slope_mm())), HasSubstr("(numpy: a.astype(np.float32), in m)"));
  EXPECT_THAT(error(npy("<u2", slope_mm(), 1, "True")), HasSubstr("is in the order of Fortran"));
  EXPECT_THAT(error(npy("<u2", slope_mm(), 9)), HasSubstr("is not a whole NPY array"));
  EXPECT_THAT(error(npyFile("<u2", "1, 24, 32", toBytes(slope_mm()))),
              HasSubstr("has the shape (1, 24, 32), not (height, width)"));
  EXPECT_THAT(error(npy("<u2", cv::Mat(1, 9000, CV_16UC1))),
              HasSubstr("is 9000x1, larger than 8192 px a side"));
  EXPECT_THAT(error(npy("<u2", slope_mm()).substr(0, 600)), HasSubstr("is cut off"));
  std::filesystem::remove_all(folder / "depth");
  folder.write("depth/0.xyz", std::string("x"));
  EXPECT_THAT(openError(),
              HasSubstr("depth: has no PNG, JPEG, TIFF, EXR, PGM, PFM, NPY or NPZ images"));
}

TEST_F(DepthFile, WrongPfmAndNpzAreNamed) {
  const auto error = [this](const std::string& ending, const std::string& text) {
    fill(ending, text);
    return openError();
  };
  const std::string good = pfm(slope_m(), false);
  EXPECT_THAT(error(".pfm", "PF" + good.substr(2)), HasSubstr("is a PFM image in colours"));
  EXPECT_THAT(error(".pfm", "Pf\n32\n"), HasSubstr("is not a whole PFM image"));
  EXPECT_THAT(error(".pfm", "Pf\n32 -24\n-1\n"), HasSubstr("is not a whole PFM image"));
  EXPECT_THAT(error(".pfm", "Pf\n99999 99999\n-1\n"), HasSubstr("is 99999x99999, larger than"));
  EXPECT_THAT(error(".pfm", good.substr(0, good.size() - 1)), HasSubstr("is cut off"));
  std::filesystem::remove_all(folder / "depth");
  std::filesystem::create_directories(folder / "depth");
  const std::string archive = npz("<u2", slope_mm(), 8);
  EXPECT_THAT(error(".npz", archive.substr(0, archive.size() / 2)), HasSubstr("is cut off"));
  EXPECT_THAT(error(".npz", npzFile({{"a.npy", "x"}, {"b.npy", "x"}})),
              HasSubstr("has the arrays a, b, but none has the name depths or depth"));
  EXPECT_THAT(error(".npz", npzFile({{"a.txt", "x"}})), HasSubstr("has no array"));
  EXPECT_THAT(error(".npz", npzFile({{"a.npy", npyFile("<f8", "8192, 8192", "")}})),
              HasSubstr("is 8192x8192, larger than"));
  EXPECT_THAT(error(".npz", npzFile({{"a.npy", npyFile("<f8", "4320, 8192", "")}})),
              HasSubstr("is cut off"));
  std::string damaged = npz("<u2", slope_mm(), 0);
  damaged[500] = static_cast<char>(damaged[500] + 1);
  EXPECT_THAT(error(".npz", damaged), HasSubstr("is cut off or damaged"));
}

TEST_F(DepthFile, CutAndChangedFilesAreRefusedOrHaveTheirSize) {
  fill(".tif", slope_mm());
  fill(".exr", slope_m());
  fill(".pgm", slope_mm());
  fill(".npy", npy("<f4", slope_m()));
  fill(".pfm", pfm(slope_m(), false));
  fill(".npz", npz("<f4", slope_m(), 8));
  std::mt19937 random(34);
  for (const std::string name : {"0.tif", "0.exr", "0.pgm", "0.npy", "0.pfm", "0.npz"}) {
    const std::string good = readBytes("depth/" + name);
    for (int i = 0; i < 200; ++i) {
      std::string bytes = good;
      if (i % 2 == 0) bytes.resize(random() % bytes.size());
      for (unsigned n = random() % 8; n > 0 && !bytes.empty(); --n)
        bytes[random() % std::min<std::size_t>(bytes.size(), 400)] =
            static_cast<char>(random() % 256);
      const ImageResult image =
          decodeImage({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                      cv::IMREAD_UNCHANGED);
      ASSERT_TRUE(!image.ok() || sizeReadable(image.image.cols, image.image.rows)) << name;
    }
  }
}

TEST_F(DepthFile, TheUsualNamesOfFoldersAreFound) {
  fill(".npy", npy("<u2", slope_mm()));
  for (const char* name : {"aligned_depth", "depth_aligned", "depths"}) {
    const auto other = folder / (std::string("as_") + name);
    std::filesystem::create_directories(other);
    std::filesystem::copy(folder / "rgb", other / "image");
    std::filesystem::copy(folder / "depth", other / name);
    EXPECT_EQ(ImageSequence(other, 0.0).info().frame_count, 3U) << name;
  }
}

TEST_F(DepthFile, AMissingFrameIsAGapThatIsNamedOnce) {
  fill(".npy", npy("<u2", slope_mm()));
  for (const int missing : {0, 1, 2}) {
    const auto gap = folder / ("without_" + std::to_string(missing));
    std::filesystem::create_directories(gap);
    std::filesystem::copy(folder / "rgb", gap / "rgb");
    std::filesystem::copy(folder / "depth", gap / "depth");
    std::filesystem::remove(gap / "depth" / (std::to_string(missing) + ".npy"));
    const LogLines log;
    ImageSequence source(gap, 0.0);
    std::vector<std::uint64_t> read;
    while (const auto frame = source.read()) read.push_back(frame->index);
    std::vector<std::uint64_t> expected{0, 1, 2};
    expected.erase(expected.begin() + missing);
    EXPECT_EQ(read, expected) << "the others keep their times";
    EXPECT_THAT(log.text(), HasSubstr(std::to_string(missing) + ".png: has no depth image; frame " +
                                      std::to_string(missing) + " is left out"));
    EXPECT_EQ(log.count(), 1);
  }
}

}  // namespace
}  // namespace hapticast::server
