// SPDX-License-Identifier: MIT
#include "server/stream/signing_key_file.hpp"
#include "server/stream/key_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "server/stream/frame_signer.hpp"
#include "tests/support/log_lines.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::server {
namespace {

namespace fs = std::filesystem;

std::string refusal(const std::string& file) {
  try {
    (void)loadSigningKey(file);
  } catch (const KeyFileError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SigningKeyFileTest, ANewFileIsCreatedAndHasTheSameKeyInTheNextRun) {
  const TempFolder folder;
  const fs::path file = folder / "keys/origin.pem";
  const SigningKey first = loadSigningKey(file);
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  SigningKey second = loadSigningKey(file);
  EXPECT_EQ(second.verifyingKey(), first.verifyingKey());
  EXPECT_NE(loadSigningKey(folder / "other.pem").verifyingKey(), first.verifyingKey());
  const KeyBytes key = second.verifyingKey();
  const FrameSigner signer(std::move(second));
  EXPECT_EQ(signer.identity().verifying_key, key);
  EXPECT_FALSE(signer.identity().probe.empty());
}

TEST(SigningKeyFileTest, WarnsIfOthersMayReadTheFile) {
  const TempFolder folder;
  const fs::path file = folder / "origin.pem";
  (void)loadSigningKey(file);
  LogLines log;
  (void)loadSigningKey(file);
  EXPECT_EQ(log.count(), 0) << log.text();
  fs::permissions(file, fs::perms::group_read, fs::perm_options::add);
  (void)loadSigningKey(file);
  EXPECT_EQ(log.count(), 1) << log.text();
  EXPECT_NE(log.text().find("(mode 0640)"), std::string::npos) << log.text();
}

TEST(SigningKeyFileTest, ReportsAnErrorInOneLine) {
  const TempFolder folder;
  const std::string no_key = folder.write("no_key", "text");
  EXPECT_EQ(refusal(no_key),
            "--signing-key " + no_key +
                ": is not a private key of Ed25519 in PEM without a password; name a file that "
                "does not exist, and the server creates a key");
  EXPECT_EQ(std::ifstream(no_key).get(), 't') << "nothing is overwritten";
  EXPECT_EQ(refusal(folder.string()), "--signing-key " + folder.string() +
                                          ": cannot be read (it is no file); name a file that you "
                                          "may read");
  EXPECT_EQ(refusal(no_key + "/below"),
            "--signing-key " + no_key +
                "/below: cannot be written (Not a directory); name a file in a folder of yours");
}

}  // namespace
}  // namespace hapticast::server
