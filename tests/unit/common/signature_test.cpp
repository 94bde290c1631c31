// SPDX-License-Identifier: MIT
#include "common/transport/signature.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace hapticast {
namespace {

using SignedBytes = std::vector<std::uint8_t>;

SignedBytes unhex(std::string_view text) {
  const auto digit = [](char c) {
    return static_cast<std::uint8_t>(c <= '9' ? c - '0' : c - 'a' + 10);
  };
  SignedBytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(digit(text[i]) << 4U | digit(text[i + 1])));
  return bytes;
}

KeyBytes keyOf(std::string_view hex) {
  KeyBytes key{};
  const SignedBytes bytes = unhex(hex);
  std::copy(bytes.begin(), bytes.end(), key.begin());
  return key;
}

struct TestVector {
  std::string_view seed, verifying_key, message, signature;
};

// RFC 8032, section 7.1.
constexpr std::array<TestVector, 3> kVectors{{
    {"9d61b19deffd5a60ba844af492ec2cc44449c5697b326919703bac031cae7f60",
     "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a", "",
     "e5564300c360ac729086e2cc806e828a84877f1eb8e5d974d873e065224901555fb8821590a33bacc61e39701cf9"
     "b46bd25bf5f0595bbe24655141438e7a100b"},
    {"4ccd089b28ff96da9db6c346ec114e0f5b8a319f35aba624da8cf6ed4fb8a6fb",
     "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c", "72",
     "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da085ac1e43e15996e458f3613d0f1"
     "1d8c387b2eaeb4302aeeb00d291612bb0c00"},
    {"c5aa8df43f9f837bedb7442f31dcb7b166d38535076f094b85ce3a2e0b4458f7",
     "fc51cd8e6218a1a38da47ed00230f0580816ed13ba3303ac5deb911548908025", "af82",
     "6291d657deec24024827e69c3abe01a30ce548a284743a445e3680d7db5ac3ac18ff9b538d16f290ae67f760984d"
     "c6594a7c15e9716ed28dc027beceea1ec40a"},
}};

TEST(SignatureTest, KeysAreWrittenInHex) {
  const KeyBytes key = keyOf(kVectors[0].verifying_key);
  EXPECT_EQ(toHex(key), kVectors[0].verifying_key);
  EXPECT_EQ(parseKey(toHex(key)), key);
  EXPECT_EQ(parseKey(toHex(key).substr(1)), std::nullopt);
  EXPECT_EQ(parseKey(toHex(key) + "0"), std::nullopt);
  EXPECT_EQ(parseKey("-1" + toHex(key).substr(2)), std::nullopt);
  EXPECT_EQ(parseKey("0x" + toHex(key).substr(2)), std::nullopt);
  EXPECT_EQ(parseKey(toHex(key).substr(2) + "1g"), std::nullopt);
}

// Of `openssl genpkey`: Ed25519; RSA; Ed25519 with a password; Ed25519, the public key.
constexpr const char* kEd25519Pem =
    "-----BEGIN PRIVATE KEY-----\n"
    "MC4CAQAwBQYDK2VwBCIEIJ1hsZ3v/VpguoRK9JLsLMREScVpezJpGXA7rAMcrn9g\n"
    "-----END PRIVATE KEY-----\n";
constexpr const char* kRsaPem =
    "-----BEGIN PRIVATE KEY-----\n"
    "MIIBVQIBADANBgkqhkiG9w0BAQEFAASCAT8wggE7AgEAAkEA3dNLel9P5ZEFQ4NL\n"
    "S9i6BfzOeMMm7wg4wrC4Q/7woFLZVSOryyz6047NyMVQipbBxv8dPrOEtCriztWp\n"
    "rxlnZwIDAQABAkAgE771ajT+iHMPaTwJMsTrurwMwIOvyyuSE8YBpysas7tn6F2M\n"
    "EVX+QtHmH1oY/04+QgQZumgMM1iAPDbNZ7dhAiEA78hH3s1elsdKMoZYoKdCJMEZ\n"
    "uVfjuOHlkczc7n/1OLcCIQDs1BjyA6TlxizG4vtO+9jjbhq0Kdf8srWQA0aijwy2\n"
    "0QIhAOt/ewbaESJpDPhedkEixJWwiYE9TszQIFZ4LCyZw9A1AiAxLLkhR3Bt5YBW\n"
    "q7rS46hdUPdqgWW/qrvYc1WvW1SggQIhAKk2mrfuu5O1ahmrx913RYn2BEgC7P76\n"
    "EkgQiKml/LSF\n"
    "-----END PRIVATE KEY-----\n";
constexpr const char* kLockedPem =
    "-----BEGIN ENCRYPTED PRIVATE KEY-----\n"
    "MIGbMFcGCSqGSIb3DQEFDTBKMCkGCSqGSIb3DQEFDDAcBAhd2rh5V1ielQICCAAw\n"
    "DAYIKoZIhvcNAgkFADAdBglghkgBZQMEASoEEOi9LwONVTOgzAHoa6tFzbkEQG89\n"
    "Uj8Np1LLhaBEZ4P7vEp0QveZTwkQNp6022vBF0dP9ytVfSXfGJ/nX13UcCMJfGY0\n"
    "2hUHW1GhKkz2b9E29qY=\n"
    "-----END ENCRYPTED PRIVATE KEY-----\n";
constexpr const char* kPublicPem =
    "-----BEGIN PUBLIC KEY-----\n"
    "MCowBQYDK2VwAyEA11qYAYKxCrfVS/7TyWQHOg7hcvPapiMlrwIaaPcHURo=\n"
    "-----END PUBLIC KEY-----\n";

TEST(SignatureTest, KeysTravelInPem) {
  auto key = SigningKey::fromPem(kEd25519Pem);
  ASSERT_TRUE(key.ok()) << key.error().message;
  EXPECT_EQ(key.value().verifyingKey(), keyOf(kVectors[0].verifying_key));
  EXPECT_EQ(key.value().toPem(), kEd25519Pem);
  const Signature signature = key.value().sign({});
  EXPECT_EQ(SignedBytes(signature.begin(), signature.end()), unhex(kVectors[0].signature));
  for (const std::string& wrong :
       {std::string(), std::string("text"), std::string(kEd25519Pem).substr(0, 60),
        std::string(kRsaPem), std::string(kLockedPem), std::string(kPublicPem)}) {
    EXPECT_FALSE(SigningKey::fromPem(wrong).ok()) << wrong;
  }
}

TEST(SignatureTest, AsTheStandardsExamplesSay) {
  for (const TestVector& each : kVectors) {
    SigningKey key(keyOf(each.seed));
    EXPECT_EQ(key.verifyingKey(), keyOf(each.verifying_key));
    const SignedBytes message = unhex(each.message);
    for (int twice = 0; twice < 2; ++twice) {
      const Signature signature = key.sign(message);
      EXPECT_EQ(SignedBytes(signature.begin(), signature.end()), unhex(each.signature));
    }
    const auto verifying = VerifyingKey::from(unhex(each.verifying_key));
    ASSERT_TRUE(verifying.ok());
    EXPECT_TRUE(verifying.value().verify(message, unhex(each.signature)));
  }
}

TEST(SignatureTest, RefusesASignatureWithAChangedBit) {
  SigningKey key;
  const auto verifying = VerifyingKey::from(key.verifyingKey());
  ASSERT_TRUE(verifying.ok());
  SignedBytes message(1160, 7);
  Signature signature = key.sign(message);
  for (std::size_t bit = 0; bit < 8 * message.size(); bit += 331) {
    message[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_FALSE(verifying.value().verify(message, signature));
    message[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
  }
  for (std::size_t bit = 0; bit < 8 * signature.size(); bit += 7) {
    signature[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_FALSE(verifying.value().verify(message, signature));
    signature[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
  }
  EXPECT_TRUE(verifying.value().verify(message, signature)) << "what was refused leaves no trace";
  EXPECT_FALSE(verifying.value().verify(message, std::span(signature).first(63)));
  EXPECT_FALSE(VerifyingKey::from(SigningKey().verifyingKey()).value().verify(message, signature))
      << "another one's key";
}

TEST(SignatureTest, AKeyHasItsSize) {
  for (const std::size_t size : {0U, 31U, 33U, 64U})
    EXPECT_FALSE(VerifyingKey::from(SignedBytes(size, 1)).ok()) << size;
}

TEST(SignatureTest, RandomNumbersDoNotRepeat) {
  std::set<std::uint64_t> seen{0};
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(seen.insert(makeUnguessable()).second);
}

}  // namespace
}  // namespace hapticast
