// SPDX-License-Identifier: MIT
#include "tests/scenes/false_streams/malicious_server.hpp"

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

void OutgoingFrame::setRelief(std::shared_ptr<const Relief> relief) {
  object().relief = std::move(relief);
  object().changed_in_frame = frame.id;
}

std::vector<OutgoingDatagrams::Part> OutgoingDatagrams::partsOf(const CodedFrame& frame) {
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

double OutgoingFrame::between(double low, double high) {
  return std::uniform_real_distribution(low, high)(random);
}

MaliciousServer::MaliciousServer(const FalseStream& false_stream) : false_stream_(false_stream) {}

void MaliciousServer::offers(std::uint16_t datagram_port, DatagramGroup group) {
  port_ = datagram_port;
  group_ = std::move(group);
}

Bytes MaliciousServer::welcome() {
  next_ = 0;
  Welcome welcome;
  if (isSigned()) {
    welcome.stream = kStream;
    welcome.verifying_key = key_.verifyingKey();
  }
  if (false_stream_.alter_datagrams) {
    welcome.datagram_token = kToken;
    welcome.datagram_port = port_;
    welcome.group = group_;
  }
  welcome.description.name = false_stream_.name;
  welcome.description.fps = kFalseStreamFps;
  if (false_stream_.announce) false_stream_.announce(welcome.description);
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
  for (; static_cast<double>(next_) / kFalseStreamFps <= until_s; ++next_) {
    const double t_s = static_cast<double>(next_) / kFalseStreamFps;
    OutgoingFrame outgoing{t_s, next_, random_, honestFrame(t_s)};
    false_stream_.alter(outgoing);
    if (outgoing.silent) continue;
    if (outgoing.description) out.push_back(encode(*outgoing.description));
    if (false_stream_.alter_datagrams) {
      const CodedFrame frame = coder_.code(outgoing.frame, kFinestSlices);
      alterDatagrams(t_s, frame);
      if (false_stream_.on_tcp) out.push_back(encodeFrame(frame));
      continue;
    }
    const Bytes bytes =
        outgoing.bytes ? *outgoing.bytes : encodeFrame(coder_.code(outgoing.frame, kFinestSlices));
    out.insert(out.end(), static_cast<std::size_t>(outgoing.copies), bytes);
  }
  return out;
}

Bytes MaliciousServer::encodeFrame(const CodedFrame& frame) {
  return isSigned() ? *encodeSigned(frame, kStream, key_) : encode(frame);
}

void MaliciousServer::alterDatagrams(double t_s, const CodedFrame& frame) {
  OutgoingDatagrams outgoing{t_s, next_, random_, frame, OutgoingDatagrams::partsOf(frame)};
  false_stream_.alter_datagrams(outgoing);
  for (const OutgoingDatagrams::Part& part : outgoing.parts)
    datagrams_.push_back(signedBody(part.header, part.payload, key_));
}

std::vector<Bytes> MaliciousServer::takeDatagrams() { return std::exchange(datagrams_, {}); }

Bytes MaliciousServer::probe() { return probeBody(kStream, key_); }

std::optional<Bytes> MaliciousServer::answer(const Ping& ping, double now_s) const {
  if (!false_stream_.answers) return std::nullopt;
  const double media_s = kMediaBegin_s + now_s;
  const MediaTime pong_time =
      false_stream_.clock != nullptr ? mediaTime(false_stream_.clock(media_s)) : mediaTime(media_s);
  return encode(Pong{ping.t0, pong_time, pong_time});
}

}  // namespace hapticast::testing
