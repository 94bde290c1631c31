// SPDX-License-Identifier: MIT
#include "tests/support/malicious_server.hpp"

#include <utility>

#include "common/protocol/fragment.hpp"
#include "common/protocol/signed_frame.hpp"
#include "tests/support/flat_relief.hpp"

namespace hapticast::testing {

namespace {
constexpr double kMediaBegin_s = 500.0;  // of the server's clock at the welcome
constexpr std::uint64_t kRepeatEvery = 25;
constexpr std::uint32_t kStream = 1;
}  // namespace

const char* verdictName(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kRefused:
      return "refused";
    case Verdict::kLimited:
      return "limited";
    case Verdict::kTrustLost:
      return "trust lost";
    case Verdict::kHarmless:
      break;
  }
  return "harmless";
}

void Telling::shows(std::shared_ptr<const Relief> relief) {
  object().relief = std::move(relief);
  object().changed_in_frame = frame.id;
}

std::vector<PartsTelling::Part> PartsTelling::partsOf(const CodedFrame& frame) {
  std::vector<Bytes> payloads = packFrame(frame);
  std::vector<Part> parts;
  parts.reserve(payloads.size());
  for (Bytes& payload : payloads) {
    parts.push_back(
        {{kStream, frame.epoch, frame.id, frame.media_time,
          static_cast<std::uint16_t>(parts.size()), static_cast<std::uint16_t>(payloads.size())},
         std::move(payload)});
  }
  return parts;
}

double Telling::between(double low, double high) {
  return std::uniform_real_distribution(low, high)(random);
}

MaliciousServer::MaliciousServer(const Lie& lie) : lie_(lie) {}

void MaliciousServer::offers(std::uint16_t datagram_port, DatagramGroup group) {
  port_ = datagram_port;
  group_ = std::move(group);
}

Bytes MaliciousServer::welcome() {
  next_ = 0;
  Welcome welcome;
  if (lie_.tell_parts || signed_) {
    welcome.stream = kStream;
    welcome.verifying_key = key_.verifyingKey();
  }
  if (lie_.tell_parts) {
    welcome.datagram_token = kToken;
    welcome.datagram_port = port_;
    welcome.group = group_;
  }
  welcome.description.name = lie_.name;
  welcome.description.fps = kLiarsFps;
  if (lie_.announce) lie_.announce(welcome.description);
  return encode(welcome);
}

HapticFrame MaliciousServer::honestFrame(double t_s) const {
  static const std::shared_ptr<const Relief> plateau = flatRelief(kPlateau_px, kPlateau_mm);
  HapticFrame frame;
  frame.id = next_;
  frame.media_time = mediaTime(kMediaBegin_s + t_s);
  HapticObject object;
  object.id = 1;
  if (next_ % kRepeatEvery == 0) object.relief = plateau;
  object.motion.position_mm.z() = double{kPlateau_mm};
  frame.objects.push_back(std::move(object));
  return frame;
}

std::vector<Bytes> MaliciousServer::messages(double until_s) {
  std::vector<Bytes> out;
  for (; static_cast<double>(next_) / kLiarsFps <= until_s; ++next_) {
    const double t_s = static_cast<double>(next_) / kLiarsFps;
    Telling telling{t_s, next_, random_, honestFrame(t_s)};
    lie_.tell(telling);
    if (telling.silent) continue;
    if (telling.description) out.push_back(encode(*telling.description));
    if (lie_.tell_parts) {
      const CodedFrame frame = coder_.code(telling.frame, kFinestSlices);
      lieInParts(t_s, frame);
      if (lie_.on_tcp) out.push_back(encodeFrame(frame));
      continue;
    }
    const Bytes bytes =
        telling.bytes ? *telling.bytes : encodeFrame(coder_.code(telling.frame, kFinestSlices));
    out.insert(out.end(), static_cast<std::size_t>(telling.copies), bytes);
  }
  return out;
}

Bytes MaliciousServer::encodeFrame(const CodedFrame& frame) {
  return signed_ ? *encodeSigned(frame, kStream, key_) : encode(frame);
}

void MaliciousServer::lieInParts(double t_s, const CodedFrame& frame) {
  PartsTelling telling{t_s, next_, random_, frame, PartsTelling::partsOf(frame)};
  lie_.tell_parts(telling);
  for (const PartsTelling::Part& part : telling.parts)
    datagrams_.push_back(signedBody(part.header, part.payload, key_));
}

std::vector<Bytes> MaliciousServer::takeDatagrams() { return std::exchange(datagrams_, {}); }

Bytes MaliciousServer::probe() { return probeBody(kStream, key_); }

std::optional<Bytes> MaliciousServer::answer(const Ping& ping, double now_s) const {
  if (!lie_.answers) return std::nullopt;
  const double media_s = kMediaBegin_s + now_s;
  const MediaTime told =
      lie_.clock != nullptr ? mediaTime(lie_.clock(media_s)) : mediaTime(media_s);
  return encode(Pong{ping.t0, told, told});
}

}  // namespace hapticast::testing
