// SPDX-License-Identifier: MIT
// Which servers the client accepts, and the file that remembers their keys.
#include "client/net/origin_pin.hpp"

#include <gtest/gtest.h>

#include <cctype>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "client/servers/known_origins.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::client {
namespace {

constexpr const char* kServer = "host:7447";

KeyBytes keyOf(std::uint8_t byte) {
  KeyBytes key;
  key.fill(byte);
  return key;
}

std::string hexOf(std::uint8_t byte) { return toHex(keyOf(byte)); }

std::string contentOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(OriginPinTest, WithoutAKeyItAcceptsEveryServer) {
  OriginPin pin;
  EXPECT_EQ(pin.refuse(std::nullopt), std::nullopt);
  EXPECT_EQ(pin.refuse(keyOf(1)), std::nullopt);
}

TEST(OriginPinTest, AcceptsTheExpectedKeysOnly) {
  OriginPin pin(kServer, {keyOf(1), keyOf(2)});
  EXPECT_EQ(pin.refuse(keyOf(1)), std::nullopt);
  EXPECT_EQ(pin.refuse(keyOf(2)), std::nullopt);
  EXPECT_EQ(pin.refuse(keyOf(3)),
            "the server at host:7447 shows the key " + hexOf(3) +
                ", not the expected one: somebody else may send, or the server has a new key "
                "(--origin-key)");
  EXPECT_EQ(pin.refuse(std::nullopt),
            "the server at host:7447 shows no key, not the expected one: somebody else may send, "
            "or the server has a new key (--origin-key)");
}

TEST(OriginPinTest, ReadsKeysAndFirst) {
  EXPECT_EQ(parseOriginKey("first"), OriginKey{});
  EXPECT_EQ(parseOriginKey(hexOf(0xAB)), OriginKey{keyOf(0xAB)});
  std::string capitals = hexOf(0xAB);
  for (char& each : capitals) each = static_cast<char>(std::toupper(each));
  EXPECT_EQ(parseOriginKey(capitals), OriginKey{keyOf(0xAB)});
  for (const std::string& wrong :
       {std::string(), std::string("First"), hexOf(1) + "0", hexOf(1).substr(1),
        hexOf(1).substr(2) + "0x", hexOf(1).substr(2) + " 1"}) {
    EXPECT_EQ(parseOriginKey(wrong), std::nullopt) << wrong;
  }
}

class KnownOriginsTest : public ::testing::Test {
 protected:
  [[nodiscard]] OriginPin first(const std::string& server = kServer,
                                std::vector<OriginKey> more = {}) const {
    more.push_back({});
    return makeOriginPin(more, server, file_);
  }
  TempFolder folder_;
  std::filesystem::path file_ = folder_ / "state/known_origins";
};

TEST_F(KnownOriginsTest, TheFirstKeyIsStoredAndHasToStay) {
  OriginPin pin = first();
  EXPECT_NE(pin.refuse(std::nullopt), std::nullopt) << "no key to store";
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_EQ(pin.refuse(keyOf(1)), std::nullopt);
  EXPECT_EQ(contentOf(file_), "host:7447 " + hexOf(1) + "\n");
  EXPECT_EQ(std::filesystem::status(file_).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  EXPECT_EQ(pin.refuse(keyOf(1)), std::nullopt);
  const std::string remedy = "; to accept its new key, delete line 1 of " + file_.string();
  EXPECT_TRUE(pin.refuse(keyOf(2))->ends_with(remedy)) << "in the same run";
  OriginPin later = first();
  EXPECT_EQ(later.refuse(keyOf(1)), std::nullopt);
  EXPECT_TRUE(later.refuse(keyOf(2))->ends_with(remedy)) << *later.refuse(keyOf(2));
  EXPECT_EQ(contentOf(file_), "host:7447 " + hexOf(1) + "\n");
}

TEST_F(KnownOriginsTest, EachServerHasALine) {
  folder_.write("state/known_origins", "mdns:My server " + hexOf(9));  // edited by hand
  EXPECT_EQ(first("host:1").refuse(keyOf(1)), std::nullopt);
  EXPECT_EQ(contentOf(file_), "mdns:My server " + hexOf(9) + "\nhost:1 " + hexOf(1) + "\n");
  OriginPin announced = first("mdns:My server");
  EXPECT_EQ(announced.refuse(keyOf(9)), std::nullopt);
  EXPECT_NE(announced.refuse(keyOf(1)), std::nullopt);
  OriginPin other = first("host:1");
  EXPECT_NE(other.refuse(keyOf(9)), std::nullopt);
  EXPECT_NE(other.refuse(keyOf(9))->find("delete line 2 of "), std::string::npos);
}

TEST_F(KnownOriginsTest, KeysMayBeNamedBesides) {
  OriginPin pin = first(kServer, {{keyOf(5)}});
  EXPECT_EQ(pin.refuse(keyOf(5)), std::nullopt);
  EXPECT_FALSE(std::filesystem::exists(file_)) << "it is known already";
  EXPECT_EQ(pin.refuse(keyOf(6)), std::nullopt);
  EXPECT_NE(pin.refuse(keyOf(7)), std::nullopt);
}

TEST_F(KnownOriginsTest, NamesTheMalformedLine) {
  for (const std::string& wrong :
       {std::string("host:1"), "host:1 " + hexOf(1) + "0", " " + hexOf(1), hexOf(1)}) {
    folder_.write("state/known_origins", "host:1 " + hexOf(1) + "\n" + wrong + "\n");
    std::string what;
    try {
      (void)first();
    } catch (const std::runtime_error& error) {
      what = error.what();
    }
    EXPECT_TRUE(what.starts_with("--origin-key first: " + file_.string() + ":2: ")) << what;
    EXPECT_TRUE(what.ends_with("correct or delete the line")) << what;
    EXPECT_EQ(makeOriginPin({{keyOf(1)}}, kServer, file_).refuse(keyOf(1)), std::nullopt)
        << "the file does not matter";
  }
}

TEST_F(KnownOriginsTest, AKeyThatCannotBeStoredIsNotAccepted) {
  folder_.write("state", "a file, not a folder");
  OriginPin pin = first();
  const auto why = pin.refuse(keyOf(1));
  ASSERT_TRUE(why.has_value());
  EXPECT_TRUE(why->starts_with("--origin-key first: " + file_.string() + ": cannot be written ("))
      << *why;
  EXPECT_NE(pin.refuse(keyOf(1)), std::nullopt);
}

}  // namespace
}  // namespace hapticast::client
