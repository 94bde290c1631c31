// SPDX-License-Identifier: MIT
// Messages of ROS 2 and Foxglove with images: golden bytes of each type, every encoding, byte order
// and row step, cut and damaged messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "server/source/recording/image_message.hpp"
#include "server/source/recording/message_picture.hpp"
#include "tests/unit/server/image_messages.hpp"

namespace hapticast::server {
namespace {

using ::testing::HasSubstr;

MessageBytes fromHex(const std::string& text) {
  MessageBytes bytes;
  std::string digits;
  for (const char c : text) {
    if (c != ' ') digits += c;
    if (digits.size() == 2) {
      bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits, nullptr, 16)));
      digits.clear();
    }
  }
  return bytes;
}

cv::Mat drawNoise(int rows, int cols, int type, std::mt19937& random) {
  cv::Mat picture(rows, cols, type);
  for (int v = 0; v < rows; ++v)
    for (std::size_t i = 0; i < picture.elemSize() * std::size_t(cols); ++i)
      picture.ptr(v)[i] = static_cast<std::uint8_t>(random());
  return picture;
}

bool isEqual(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int v = 0; v < a.rows; ++v)
    if (std::memcmp(a.ptr(v), b.ptr(v), a.elemSize() * std::size_t(a.cols)) != 0) return false;
  return true;
}

// The bytes are those of @foxglove/rosmsg2-serialization (npm).
const MessageBytes kGoldenImage = fromHex(
    "00 01 00 00 01 00 00 00 02 00 00 00 04 00 00 00 63 61 6d 00 01 00 00 00 02 00 00 00 "
    "05 00 00 00 72 67 62 38 00 00 00 00 06 00 00 00 06 00 00 00 01 02 03 04 05 06");
const MessageBytes kGoldenCompressed = fromHex(
    "00 01 00 00 01 00 00 00 02 00 00 00 04 00 00 00 63 61 6d 00 05 00 00 00 6a 70 65 67 00 "
    "00 00 00 02 00 00 00 ff d8");
// Up to the matrix k.
const MessageBytes kGoldenCamera = fromHex(
    "00 01 00 00 01 00 00 00 02 00 00 00 04 00 00 00 63 61 6d 00 e0 01 00 00 80 02 00 00 "
    "0a 00 00 00 70 6c 75 6d 62 5f 62 6f 62 00 00 00 02 00 00 00 00 00 00 00 00 00 00 00 "
    "00 00 e0 3f 00 00 00 00 00 00 d0 3f "
    "00 00 00 00 00 40 7f 40 00 00 00 00 00 00 00 00 00 00 00 00 00 f0 73 40 "
    "00 00 00 00 00 00 00 00 00 00 00 00 00 50 7f 40 00 00 00 00 00 e0 6d 40 "
    "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 f0 3f");
// The bytes are those of protoc --encode with the schemas of Foxglove.
const MessageBytes kGoldenFoxglove = fromHex(
    "0a 04 08 01 10 02 15 02 00 00 00 1d 01 00 00 00 22 04 72 67 62 38 2d 06 00 00 00 "
    "32 06 01 02 03 04 05 06 3a 03 63 61 6d");

void expectGolden(const MessageBytes& bytes, MessageType type) {
  const auto image = readImageMessage(type, bytes);
  ASSERT_TRUE(image.ok()) << image.error().message;
  EXPECT_EQ(image.value().stamp_ns, 1'000'000'002);
  EXPECT_EQ(image.value().frame_id, "cam");
  EXPECT_EQ(image.value().width_px, 2U);
  EXPECT_EQ(image.value().height_px, 1U);
  EXPECT_EQ(image.value().encoding, "rgb8");
  const ImageResult color = readColor(image.value());
  ASSERT_TRUE(color.ok()) << color.problem;
  EXPECT_EQ(color.image.at<cv::Vec3b>(0, 0), cv::Vec3b(3, 2, 1));
  EXPECT_EQ(color.image.at<cv::Vec3b>(0, 1), cv::Vec3b(6, 5, 4));
}

TEST(ImageMessageTest, GoldenBytesAreRead) {
  expectGolden(kGoldenImage, MessageType::kRosImage);
  expectGolden(kGoldenFoxglove, MessageType::kFoxgloveImage);
  const auto compressed = readImageMessage(MessageType::kRosCompressedImage, kGoldenCompressed);
  ASSERT_TRUE(compressed.ok());
  EXPECT_EQ(compressed.value().encoding, "jpeg");
  EXPECT_EQ(compressed.value().data.size(), 2U);
  const auto camera = readCameraMessage(MessageType::kRosCameraInfo, kGoldenCamera);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->camera, (CameraModel{500.0, 501.0, 319.5, 239.5}));
  EXPECT_EQ(camera->width_px, 640U);
  EXPECT_EQ(camera->height_px, 480U);
}

TEST(ImageMessageTest, TheEncoderOfTheTestsWritesTheGoldenBytes) {
  cv::Mat pixels(1, 2, CV_8UC3);
  for (int i = 0; i < 6; ++i) pixels.data[i] = static_cast<std::uint8_t>(i + 1);
  MessageBytes image = rosImage(pixels, "rgb8", {.stamp_ns = 1'000'000'002, .frame_id = "cam"});
  std::replace(image.begin(), image.end(), std::uint8_t{0xEE}, std::uint8_t{0});  // padding
  EXPECT_EQ(image, kGoldenImage);
}

TEST(ImageMessageTest, BothFormsOfACameraAreRead) {
  for (const bool big_endian : {false, true}) {
    const auto camera =
        readCameraMessage(MessageType::kRosCameraInfo,
                          rosCameraInfo({640, 480}, 500.0, {.big_endian_cdr = big_endian}));
    ASSERT_TRUE(camera);
    EXPECT_EQ(camera->camera, (CameraModel{500.0, 1000.0, 320.5, 120.5}));
  }
  const auto camera =
      readCameraMessage(MessageType::kFoxgloveCalibration, foxgloveCalibration({640, 480}, 500.0));
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->camera, (CameraModel{500.0, 1000.0, 320.5, 120.5}));
  for (const double focal_px : {0.0, -1.0, 1e6, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_FALSE(
        readCameraMessage(MessageType::kRosCameraInfo, rosCameraInfo({640, 480}, focal_px)));
}

/// Returns `bgr` in the encoding `name`.
cv::Mat encodeColor(const cv::Mat& bgr, const std::string& name) {
  const bool alpha = name == "rgba8" || name == "bgra8";
  cv::Mat out(bgr.size(), alpha ? CV_8UC4 : CV_8UC3);
  for (int v = 0; v < bgr.rows; ++v) {
    for (int u = 0; u < bgr.cols; ++u) {
      cv::Vec3b pixel = bgr.at<cv::Vec3b>(v, u);
      if (name.starts_with("rgb")) std::swap(pixel[0], pixel[2]);
      std::uint8_t* const to = out.ptr(v, u);
      for (int i = 0; i < 3; ++i) to[i] = pixel[i];
      if (alpha) to[3] = 0x77;
    }
  }
  return out;
}

TEST(ImageMessageTest, EveryColourOfRandomPicturesComesBack) {
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    const cv::Mat bgr = drawNoise(1 + int(random() % 20), 1 + int(random() % 20), CV_8UC3, random);
    const RosForm form{.big_endian_cdr = random() % 2 == 0,
                       .big_endian_pixels = random() % 2 == 0,
                       .padding_bytes = std::uint32_t(random() % 9)};
    for (const std::string name : {"rgb8", "bgr8", "rgba8", "bgra8", "8UC3"}) {
      const cv::Mat pixels = encodeColor(bgr, name);
      const MessageBytes bytes = rosImage(pixels, name, form);
      const auto image = readImageMessage(MessageType::kRosImage, bytes);
      ASSERT_TRUE(image.ok());
      EXPECT_EQ(findKind(image.value()).kind, ImageKind::kColor);
      EXPECT_TRUE(isEqual(readColor(image.value()).image, bgr)) << name;
      EXPECT_THAT(readDepth(image.value()).problem, HasSubstr("has colours"));
      const MessageBytes proto = foxgloveImage(pixels, name);
      EXPECT_TRUE(isEqual(
          readColor(readImageMessage(MessageType::kFoxgloveImage, proto).value()).image, bgr));
    }
  }
}

TEST(ImageMessageTest, GreyIsAColour) {
  std::mt19937 random(2);
  const cv::Mat grey = drawNoise(5, 7, CV_8UC1, random);
  const MessageBytes bytes = rosImage(grey, "mono8");
  const ImageResult color = readColor(readImageMessage(MessageType::kRosImage, bytes).value());
  ASSERT_TRUE(color.ok());
  for (int v = 0; v < 5; ++v)
    for (int u = 0; u < 7; ++u)
      EXPECT_EQ(color.image.at<cv::Vec3b>(v, u), cv::Vec3b::all(grey.at<std::uint8_t>(v, u)));
}

TEST(ImageMessageTest, EveryDepthOfRandomPicturesComesBack) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    const std::string name = std::vector<std::string>{"16UC1", "mono16", "32FC1"}[random() % 3];
    const cv::Mat depth = drawNoise(1 + int(random() % 20), 1 + int(random() % 20),
                                    name == "32FC1" ? CV_32FC1 : CV_16UC1, random);
    const RosForm form{.big_endian_cdr = random() % 2 == 0,
                       .big_endian_pixels = random() % 2 == 0,
                       .padding_bytes = std::uint32_t(4 * (random() % 3))};
    const MessageBytes bytes = rosImage(depth, name, form);
    const auto image = readImageMessage(MessageType::kRosImage, bytes);
    ASSERT_TRUE(image.ok());
    EXPECT_EQ(findKind(image.value()).kind, ImageKind::kDepth);
    EXPECT_TRUE(isEqual(readDepth(image.value()).image, depth)) << name;
    EXPECT_THAT(readColor(image.value()).problem, HasSubstr("has depth, not colour"));
  }
}

TEST(ImageMessageTest, CompressedPicturesAreRead) {
  std::mt19937 random(4);
  const cv::Mat bgr = drawNoise(12, 16, CV_8UC3, random);
  const cv::Mat depth = drawNoise(12, 16, CV_16UC1, random);
  const auto read = [](const MessageBytes& bytes, MessageType type) {
    return readImageMessage(type, bytes).value();
  };
  for (const std::string format : {"png", "rgb8; png compressed bgr8"}) {
    const MessageBytes ros = rosCompressed(encodeFile(".png", bgr), format);
    EXPECT_TRUE(isEqual(readColor(read(ros, MessageType::kRosCompressedImage)).image, bgr));
    const MessageBytes proto = foxgloveCompressed(encodeFile(".png", bgr), format);
    const ImageMessage image = read(proto, MessageType::kFoxgloveCompressedImage);
    EXPECT_EQ(image.stamp_ns, 1'500'000'000);
    EXPECT_EQ(findKind(image).kind, ImageKind::kColor);
    EXPECT_TRUE(isEqual(readColor(image).image, bgr));
  }
  for (const std::string ending : {".jpg", ".webp"}) {
    const MessageBytes file = encodeFile(ending, bgr);
    const MessageBytes ros = rosCompressed(file, ending.substr(1));
    EXPECT_TRUE(isEqual(readColor(read(ros, MessageType::kRosCompressedImage)).image,
                        cv::imdecode(file, cv::IMREAD_COLOR)));
  }
  for (const MessageBytes& ros :
       {rosCompressed(encodeFile(".png", depth), "16UC1; png compressed "),
        rosCompressed(pluginDepth(depth), "16UC1; compressedDepth png"),
        rosCompressed(pluginDepth(depth), "16UC1; compressedDepth")}) {
    const ImageMessage image = read(ros, MessageType::kRosCompressedImage);
    EXPECT_EQ(findKind(image).kind, ImageKind::kDepth);
    EXPECT_TRUE(isEqual(readDepth(image).image, depth));
    EXPECT_FALSE(readColor(image).ok() && image.encoding.find("Depth") != std::string_view::npos);
  }
}

TEST(ImageMessageTest, InverseDepthIsInMetres) {
  // As the plugin of ROS writes it: at most 10 m, quantised from 100.
  const float a = 100.0F * 101.0F;
  const float b = 1.0F - a / 10.0F;
  cv::Mat values(1, 4, CV_16UC1);
  const std::array<float, 4> depths_m{0.0F, 0.5F, 2.0F, 9.5F};
  for (int u = 0; u < 4; ++u)
    values.at<std::uint16_t>(0, u) =
        u == 0 ? 0 : static_cast<std::uint16_t>(a / depths_m[std::size_t(u)] + b);
  const MessageBytes bytes = rosCompressed(pluginDepth(values, a, b), "32FC1; compressedDepth png");
  const ImageResult depth =
      readDepth(readImageMessage(MessageType::kRosCompressedImage, bytes).value());
  ASSERT_TRUE(depth.ok()) << depth.problem;
  ASSERT_EQ(depth.image.type(), CV_32FC1);
  for (int u = 0; u < 4; ++u) {
    const float true_m = depths_m[std::size_t(u)];
    // One step of the quantisation.
    EXPECT_NEAR(depth.image.at<float>(0, u), true_m, true_m * true_m / a + 1e-6F);
  }
}

TEST(ImageMessageTest, WrongPicturesAreRefused) {
  const auto describeProblem = [](const MessageBytes& bytes) {
    const auto image = readImageMessage(MessageType::kRosImage, bytes);
    return image.ok() ? readDepth(image.value()).problem : image.error().message;
  };
  const cv::Mat depth = cv::Mat::ones(2, 3, CV_16UC1);
  const auto withSize = [](std::uint32_t height, std::uint32_t width, std::uint32_t row_bytes) {
    CdrOut out = rosHeader({});
    out.uint32(height).uint32(width).text("16UC1").uint8(0).uint32(row_bytes);
    return out.bytes(MessageBytes(12)).message();
  };
  EXPECT_EQ(describeProblem(rosImage(depth, "16UC1")), "");
  EXPECT_EQ(describeProblem(withSize(2, 3, 6)), "");
  EXPECT_THAT(describeProblem(rosImage(depth, "bayer_rggb8")), HasSubstr("'bayer_rggb8'"));
  EXPECT_THAT(describeProblem(withSize(0, 3, 6)), HasSubstr("has no pixels"));
  EXPECT_THAT(describeProblem(withSize(2, 3, 5)), HasSubstr("shorter than its pixels"));
  EXPECT_THAT(describeProblem(withSize(2, 2, 5)), HasSubstr("odd number of bytes"));
  EXPECT_THAT(describeProblem(withSize(3, 3, 6)), HasSubstr("less data"));
  EXPECT_THAT(describeProblem(withSize(9000, 3, 6)), HasSubstr("is 3x9000, larger than"));
  EXPECT_THAT(describeProblem(withSize(0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF)),
              HasSubstr("larger than"));
  EXPECT_THAT(describeProblem({0, 7, 0, 0, 1, 2, 3, 4}), HasSubstr("CDR 1"));
  EXPECT_THAT(describeProblem({}), HasSubstr("cut off"));
  const MessageBytes rvl = rosCompressed(pluginDepth(depth), "16UC1; compressedDepth rvl");
  EXPECT_THAT(readDepth(readImageMessage(MessageType::kRosCompressedImage, rvl).value()).problem,
              HasSubstr("RVL"));
}

struct Sample {
  MessageType type;
  MessageBytes bytes;
};

std::vector<Sample> makeSamples() {
  std::mt19937 random(5);
  const cv::Mat bgr = drawNoise(6, 8, CV_8UC3, random);
  const cv::Mat depth = drawNoise(6, 8, CV_16UC1, random);
  const RosForm big{.big_endian_cdr = true, .big_endian_pixels = true, .padding_bytes = 2};
  return {
      {MessageType::kRosImage, rosImage(bgr, "rgb8")},
      {MessageType::kRosImage, rosImage(depth, "16UC1", big)},
      {MessageType::kRosCompressedImage, rosCompressed(encodeFile(".jpg", bgr), "jpeg")},
      {MessageType::kRosCompressedImage,
       rosCompressed(pluginDepth(depth, 1.0F, 2.0F), "32FC1; compressedDepth png")},
      {MessageType::kRosCameraInfo, rosCameraInfo({8, 6}, 10.0)},
      {MessageType::kFoxgloveImage, foxgloveImage(depth, "16UC1")},
      {MessageType::kFoxgloveCompressedImage, foxgloveCompressed(encodeFile(".png", depth), "png")},
      {MessageType::kFoxgloveCalibration, foxgloveCalibration({8, 6}, 10.0)}};
}

/// Reads `bytes` in every way. Returns whether a picture or intrinsics came out. Requires a result
/// that its limits allow, or a problem.
bool readEveryWay(MessageType type, const MessageBytes& bytes) {
  if (isCameraType(type)) return readCameraMessage(type, bytes).has_value();
  const auto image = readImageMessage(type, bytes);
  if (!image.ok()) {
    EXPECT_NE(image.error().message, "");
    return false;
  }
  bool any = false;
  for (const ImageResult& result : {readColor(image.value()), readDepth(image.value())}) {
    EXPECT_EQ(result.ok(), !result.image.empty()) << result.problem;
    EXPECT_TRUE(!result.ok() || sizeReadable(result.image.cols, result.image.rows));
    any = any || result.ok();
  }
  EXPECT_EQ(findKind(image.value()).kind == ImageKind::kUnknown,
            !findKind(image.value()).problem.empty());
  return any;
}

TEST(ImageMessageTest, EveryCutMessageIsRefused) {
  for (const Sample& sample : makeSamples()) {
    EXPECT_TRUE(readEveryWay(sample.type, sample.bytes));
    for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
      const MessageBytes cut(sample.bytes.begin(),
                             sample.bytes.begin() + static_cast<std::ptrdiff_t>(size));
      const bool any = readEveryWay(sample.type, cut);
      // Protobuf has no end, and intrinsics stand before the end of their message.
      const bool may_end_early = isCameraType(sample.type) ||
                                 sample.type == MessageType::kFoxgloveImage ||
                                 sample.type == MessageType::kFoxgloveCompressedImage;
      EXPECT_TRUE(!any || may_end_early) << static_cast<int>(sample.type) << " " << size;
    }
  }
}

TEST(ImageMessageTest, DamagedMessagesAreReadOrRefused) {
  std::mt19937 random(6);
  const auto samples = makeSamples();
  std::size_t read = 0;
  constexpr std::size_t kRounds = 10'000;
  for (std::size_t round = 0; round < kRounds; ++round) {
    Sample sample = samples[round % samples.size()];
    for (auto count = 1 + random() % 4; count > 0; --count)
      sample.bytes[random() % std::min<std::size_t>(sample.bytes.size(), 200)] =
          static_cast<std::uint8_t>(random() % 3 == 0 ? 0xFF : random());
    read += readEveryWay(sample.type, sample.bytes) ? 1 : 0;
  }
  EXPECT_GT(read, kRounds / 20);
  EXPECT_LT(read, kRounds * 19 / 20);
}

}  // namespace
}  // namespace hapticast::server
