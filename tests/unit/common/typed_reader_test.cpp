// SPDX-License-Identifier: MIT
// Messages of listed types: each comes once, with its type; the first damage ends them, and an
// invalid message does so, too.
#include "common/recording/typed_reader.hpp"

#include <array>
#include <variant>

#include "tests/unit/common/mcap_fixture.hpp"

namespace hapticast {
namespace {

struct FrameBytes {
  std::vector<std::uint8_t> bytes;
};
struct PictureBytes {
  std::vector<std::uint8_t> bytes;
};
using BytesOfTypes = std::variant<FrameBytes, PictureBytes>;
const std::vector<std::uint8_t> kInvalid = {'b', 'a', 'd'};

template <class Content>
Result<Content> copyBytes(std::span<const std::uint8_t> data) {
  Content copy{{data.begin(), data.end()}};
  if (copy.bytes == kInvalid) return Error{"bad bytes"};
  return copy;
}

constexpr std::array<ContentType<BytesOfTypes>, 2> kTwoTypes = {{
    {"hapticast.proto.HapticFrame", "frame", decodeAs<BytesOfTypes, copyBytes<FrameBytes>>},
    {"foxglove.CompressedImage", "picture", decodeAs<BytesOfTypes, copyBytes<PictureBytes>>},
}};
constexpr unsigned kFrameSet = setOf(0), kPictureSet = setOf(1);

class TypedReaderTest : public McapFilesTest {
 protected:
  using Reader = TypedReader<BytesOfTypes>;

  static Reader open(const std::string& file) {
    auto opened = Reader::open(file, kTwoTypes);
    if (!opened.ok()) throw std::runtime_error(opened.error().message);
    return std::move(opened).value();
  }
  /// Returns the messages of the set `types`, with the types as their channels.
  static std::vector<Kept> choose(const std::vector<Kept>& messages, unsigned types) {
    std::vector<Kept> chosen;
    for (Kept each : messages) {
      --each.channel;
      if (each.channel < kTwoTypes.size() && (setOf(each.channel) & types) != 0)
        chosen.push_back(std::move(each));
    }
    return chosen;
  }
  static std::vector<Kept> read(Reader& reader, unsigned types) {
    std::vector<Kept> messages;
    while (const auto message = reader.next(types)) {
      const auto content = reader.decode(*message);
      if (!content) break;
      EXPECT_EQ(content->index(), message->channel);
      messages.push_back({message->channel, message->time_ns,
                          std::visit([](const auto& each) { return each.bytes; }, *content)});
    }
    EXPECT_TRUE(reader.problem().empty() || !reader.next(types));
    return messages;
  }
};

TEST_F(TypedReaderTest, GivesTheMessagesOfTheAskedTypes) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto messages = drawMessages(seed, 500, 100);
    Reader reader = open(makeFile(messages));
    EXPECT_TRUE(reader.has(kFrameSet) && reader.has(kPictureSet));
    EXPECT_EQ(reader.end_ns(), messages.back().time_ns);
    for (const unsigned types : {kFrameSet, kPictureSet, kFrameSet | kPictureSet}) {
      EXPECT_EQ(read(reader, types), choose(messages, types));
      EXPECT_EQ(reader.problem(), "");
      EXPECT_EQ(reader.makeLackError("frames").message, "has no frames");
      reader.seek(0);
    }
    auto again = reader.reopen();
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(read(again.value(), kFrameSet), choose(messages, kFrameSet));
  }
}

TEST_F(TypedReaderTest, AnInvalidMessageEndsTheMessages) {
  auto messages = drawMessages(2, 100, 100);
  messages[40].channel = 2;
  messages[40].data = kInvalid;
  Reader reader = open(makeFile(messages));
  const auto whole = choose(messages, kFrameSet | kPictureSet);
  const auto begin = read(reader, kFrameSet | kPictureSet);
  expectPrefix(begin, whole);
  EXPECT_LT(begin.size(), whole.size());
  EXPECT_EQ(reader.problem(), "has an invalid picture (bad bytes)");
  EXPECT_EQ(reader.makeLackError("ticks").message,
            "has no ticks: it has an invalid picture (bad bytes)");
  reader.setProblem("lacks a frame");
  EXPECT_EQ(reader.problem(), "has an invalid picture (bad bytes)") << "the first one stays";
  reader.seek(0);
  EXPECT_EQ(read(reader, kFrameSet), choose(messages, kFrameSet)) << "it was not decoded";
  reader.setProblem("lacks a frame");
  EXPECT_EQ(reader.problem(), "lacks a frame");
}

TEST_F(TypedReaderTest, EachChannelOfATypeCountsIfItIsProtobuf) {
  const std::string file = (folder_ / "twice.mcap").string();
  McapChannel text = makeChannel("/c", "hapticast.proto.HapticFrame");
  text.message_encoding = "json";
  {
    McapWriter writer(file, {makeChannel("/a", "hapticast.proto.HapticFrame"),
                             makeChannel("/b", "hapticast.proto.HapticFrame"), text});
    for (std::uint8_t i = 0; i < 30; ++i) writer.write(i % 3, i, Bytes{i});
  }
  Reader reader = open(file);
  EXPECT_TRUE(reader.has(kFrameSet | kPictureSet));
  EXPECT_FALSE(reader.has(kPictureSet));
  const auto messages = read(reader, kFrameSet);
  ASSERT_EQ(messages.size(), 20U);
  for (std::uint8_t i = 0; i < 20; ++i)
    EXPECT_EQ(messages[i].data, Bytes{static_cast<std::uint8_t>(i / 2 * 3 + i % 2)});
}

TEST_F(TypedReaderTest, DamageEndsTheMessagesAndMakesNone) {
  const auto messages = drawMessages(4, 100, 60);
  const auto whole = choose(messages, kFrameSet | kPictureSet);
  const Bytes bytes = readBytes(makeFile(messages));
  std::mt19937 random(4);
  for (int i = 0; i < 1000; ++i) {
    Bytes damaged = bytes;
    if (i % 2 == 0) {
      damaged.resize(random() % bytes.size());
    } else {
      damaged[random() % damaged.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
    }
    auto opened = Reader::open(changed(damaged), kTwoTypes);
    if (!opened.ok()) continue;
    const auto begin = read(opened.value(), kFrameSet | kPictureSet);
    for (const Kept& each : begin)
      EXPECT_NE(std::find(whole.begin(), whole.end(), each), whole.end());
    if (i % 2 == 0) {
      expectPrefix(begin, whole);
      EXPECT_TRUE(begin.size() == whole.size() || opened.value().problem() == "is cut off");
    }
  }
}

TEST_F(TypedReaderTest, AnyBytesEnd) {
  std::mt19937 random(5);
  const Bytes begin = readBytes(makeFile(drawMessages(5, 20, 20)));
  for (int i = 0; i < 1000; ++i) {
    Bytes bytes(begin.begin(), begin.begin() + static_cast<long>(random() % begin.size()));
    for (std::size_t more = random() % 500; more > 0; --more)
      bytes.push_back(static_cast<std::uint8_t>(random() % (i % 2 == 0 ? 256 : 8)));
    auto opened = Reader::open(changed(bytes), kTwoTypes);
    if (opened.ok()) (void)read(opened.value(), ~0U);
  }
}

}  // namespace
}  // namespace hapticast
