// SPDX-License-Identifier: MIT
// False streams as data: each row has the messages that a malicious server sends and the expected
// verdict. Each begins with an honest stream: a plateau of 10 mm that rests in the middle of the
// picture at 25 frames a second. Messages leave as bytes, and datagrams are signed: a malicious
// server has the key. Times are arguments. No threads, no sockets.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/transport/datagram.hpp"
#include "tests/support/coded.hpp"

namespace hapticast::testing {

using Bytes = std::vector<std::uint8_t>;

inline constexpr double kFalseStreamFps = 25.0;
inline constexpr PixelRect kPlateau_px{260, 180, 120, 120};  ///< +-15 mm about the middle
inline constexpr float kPlateau_mm = 10.0F;

/// Expected result of a false stream. Each includes that the force is finite, at most the peak,
/// steps no more than the chain allows, and ends.
enum class Verdict : std::uint8_t {
  kRefused,    ///< messages or objects are rejected
  kLimited,    ///< rendered within limits; a long run may lose the trust
  kTrustLost,  ///< rendered for a while, then the force is zero until it is re-armed
  kHarmless,   ///< needs no limit
};
const char* verdictName(Verdict verdict) noexcept;

/// Motion of the scripted hand.
enum class ScriptedHand : std::uint8_t {
  kHold,     ///< wants to be 6 mm under the plateau
  kShallow,  ///< 2.5 mm under it
  kPress,    ///< the client's own script
  kBeside,   ///< low beside the plateau, where its edge may come to
  kStroke,   ///< 2 mm under it, to and fro by 8 mm once a second
  kTap,      ///< 6 mm under it, up and down by 4 mm seven times a second
};

/// A frame before it is sent. The false stream changes it.
struct OutgoingFrame {
  double t_s;       ///< since the connection
  std::uint64_t n;  ///< frames before it on this connection
  std::mt19937_64& random;
  HapticFrame frame;
  std::optional<StreamDescription> description = std::nullopt;  ///< sent before the frame
  std::optional<Bytes> bytes = std::nullopt;                    ///< sent instead of it
  bool silent = false;                                          ///< nothing is sent
  int copies = 1;

  [[nodiscard]] HapticObject& object() { return frame.objects.front(); }
  [[nodiscard]] Motion& motion() { return object().motion; }
  [[nodiscard]] Material& material() { return object().material; }
  /// Replaces the plateau by `relief`, marked as changed.
  void setRelief(std::shared_ptr<const Relief> relief);
  /// Uniform.
  [[nodiscard]] double between(double low, double high);
};

/// A frame's datagrams before they are signed and sent. The false stream changes them.
struct OutgoingDatagrams {
  struct Part {
    DatagramHeader header;
    Bytes payload;
  };
  double t_s;       ///< since the connection
  std::uint64_t n;  ///< frames before it on this connection
  std::mt19937_64& random;
  CodedFrame frame;
  std::vector<Part> parts;  ///< in the order in which they are sent

  /// The parts of a frame as an honest server packs it, under this frame's stream.
  [[nodiscard]] static std::vector<Part> partsOf(const CodedFrame& frame);
};

/// A pong's time on the server's clock, from the true one, s.
using FalseClock = double (*)(double true_s);

struct FalseStream {
  std::string name;
  ScriptedHand hand = ScriptedHand::kHold;
  Verdict verdict = Verdict::kLimited;
  std::function<void(OutgoingFrame&)> alter;
  std::function<void(StreamDescription&)> announce = nullptr;
  FalseClock clock = nullptr;  ///< null: an honest one
  bool answers = true;         ///< pings
  /// Changes the datagrams of a frame; null: frames go over TCP.
  std::function<void(OutgoingDatagrams&)> alter_datagrams = nullptr;
  bool on_tcp = false;  ///< and over TCP, as `alter` changed them
};

/// All false streams.
const std::vector<FalseStream>& falseStreams();
/// `count` false streams drawn at random; they expect no verdict.
std::vector<FalseStream> drawFalseStreams(unsigned seed, int count);

class MaliciousServer {
 public:
  /// `false_stream` outlives it.
  explicit MaliciousServer(const FalseStream& false_stream);

  static constexpr std::uint64_t kToken = 0xabcdef0123456789;

  /// In the welcome from now on: where its datagrams come from, and the group that gets them, too.
  void offers(std::uint16_t datagram_port, DatagramGroup group);
  /// From now on its frames on TCP are signed, and its welcome has the key: as an edge needs it.
  void signFrames() { signed_ = true; }
  /// Its signature of these bytes.
  [[nodiscard]] Signature sign(std::span<const std::uint8_t> bytes) { return key_.sign(bytes); }
  /// A viewer has come: everything begins anew.
  [[nodiscard]] Bytes welcome();
  /// What is sent up to this time (s since the welcome), oldest first.
  [[nodiscard]] std::vector<Bytes> messages(double until_s);
  /// The bodies of the datagrams that go with the messages since the last call.
  [[nodiscard]] std::vector<Bytes> takeDatagrams();
  /// The body of an honest probe.
  [[nodiscard]] Bytes probe();
  /// Its welcome has a key, and its frames on TCP are signed.
  [[nodiscard]] bool isSigned() const { return signed_ || byDatagrams(); }
  [[nodiscard]] bool byDatagrams() const { return false_stream_.alter_datagrams != nullptr; }
  /// The answer to a ping, if one is given.
  [[nodiscard]] std::optional<Bytes> answer(const Ping& ping, double now_s) const;

 private:
  [[nodiscard]] Bytes encodeFrame(const CodedFrame& frame);
  [[nodiscard]] HapticFrame honestFrame(double t_s) const;
  void alterDatagrams(double t_s, const CodedFrame& frame);

  const FalseStream& false_stream_;
  FrameCoder coder_;
  SigningKey key_{KeyBytes{17}};
  bool signed_ = false;
  std::uint16_t port_ = 0;
  std::optional<DatagramGroup> group_;
  std::vector<Bytes> datagrams_;
  std::mt19937_64 random_{7};
  std::uint64_t next_ = 0;
};

}  // namespace hapticast::testing
