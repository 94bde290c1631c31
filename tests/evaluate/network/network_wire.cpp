// SPDX-License-Identifier: MIT
#include "tests/evaluate/network/network_wire.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "client/net/udp/loss_estimator.hpp"
#include "common/protocol/fragment.hpp"
#include "common/wire_limits.hpp"

namespace hapticast::evaluate {

namespace {

testing::LinkProfile otherWay(testing::LinkProfile profile) {
  profile.seed += 1000;
  return profile;
}

}  // namespace

SentStream::SentStream(const Stream& stream) : description(stream.description) {
  frames.reserve(stream.frames.size());
  double bytes = 0.0;
  for (const Stream::Bytes& each : stream.frames) {
    auto message = decode(*each.message);
    if (!message.ok()) throw std::runtime_error("a frame cannot be read: " + description.name);
    const auto& frame = std::get<CodedFrame>(message.value());
    std::vector<std::vector<std::uint8_t>> payloads = packFrame(frame);
    Frame sent{each.time_s, each.message, {}};
    for (std::size_t i = 0; i < payloads.size(); ++i) {
      const DatagramHeader header{1,
                                  frame.epoch,
                                  frame.id,
                                  frame.media_time,
                                  static_cast<std::uint16_t>(i),
                                  static_cast<std::uint16_t>(payloads.size())};
      bytes += double(kDatagramHeaderBytes + kSignatureBytes + payloads[i].size());
      sent.parts.push_back({header, std::move(payloads[i])});
    }
    frames.push_back(std::move(sent));
  }
  bytes_per_frame = bytes / double(std::max<std::size_t>(1, frames.size()));
}

Wire::Wire(const SentStream& stream, const Network& network, LocalTime start)
    : stream_(stream),
      network_(network),
      start_(start),
      up_{otherWay(network.link), {}, {}},
      down_{network.link, {}, {}},
      up_stream_(up_),
      down_stream_(down_),
      down_datagrams_(down_, 1),
      copies_(network.copies > 0 ? network.copies : client::LossEstimator::kFirstCopies) {}

MediaTime Wire::mediaNow(LocalTime now) const {
  return mediaTime(toSeconds(now - start_) * (1.0 + network_.drift));
}

LocalTime Wire::localAt(double media_s) const {
  return start_ + fromSeconds(media_s / (1.0 + network_.drift));
}

bool Wire::isCut(LocalTime at) const {
  const double since_s = toSeconds(at - start_) - network_.cut_from_s;
  return since_s >= 0.0 && since_s < network_.cut_s;
}

LocalTime Wire::afterCut(LocalTime at) const {
  return isCut(at) ? start_ + fromSeconds(network_.cut_from_s + network_.cut_s) : at;
}

void Wire::ping(const Ping& ping) {
  constexpr std::size_t kPing_bytes = 60;  // with TCP's and IP's headers
  const LocalTime there = afterCut(up_stream_.stream(ping.t0, kPing_bytes));
  const MediaTime media = mediaNow(there);
  const std::vector<std::uint8_t> answer = encode(Pong{ping.t0, media, media});
  under_way_.emplace(afterCut(down_stream_.stream(there, kPing_bytes)),
                     [answer](const Events& events) { events.message(answer); });
}

void Wire::order(std::uint32_t copies, LocalTime now) {
  under_way_.emplace(afterCut(up_stream_.stream(now, 60)),
                     [this, copies](const Events&) { copies_ = copies; });
}

void Wire::send(std::size_t frame) {
  const SentStream::Frame& sent = stream_.frames[frame];
  const LocalTime now = localAt(sent.time_s + toSeconds(stream_.description.pipeline_latency));
  if (!network_.datagrams) {
    arrive(afterCut(down_stream_.stream(now, sent.message->size() + 4)), sent,
           [&sent](const Events& events) { events.message(*sent.message); });
    return;
  }
  LocalTime last = now;
  for (std::size_t copy = 0; copy < std::min<std::size_t>(copies_, frame + 1); ++copy) {
    const SentStream::Frame& again = stream_.frames[frame - copy];
    for (const SentStream::Part& part : again.parts) {
      const auto arrivals = down_datagrams_.datagram(
          now, kDatagramHeaderBytes + kSignatureBytes + part.payload.size());
      if (copy == 0 && arrivals.count > 0) last = std::max(last, arrivals.at[0]);
      for (std::size_t i = 0; i < arrivals.count && !isCut(now); ++i)
        arrive(arrivals.at[i], again, [&part](const Events& events) { events.part(part); });
    }
  }
  waited_ms_.push_back(1e3 * toSeconds(last - now));
}

void Wire::arrive(LocalTime at, const SentStream::Frame& frame, Arrival arrival) {
  under_way_.emplace(at, [this, &frame, arrival = std::move(arrival)](const Events& events) {
    newest_ = std::max(newest_, mediaTime(frame.time_s));
    arrival(events);
  });
}

void Wire::deliver(LocalTime now, const Events& events) {
  const double latency_s = toSeconds(stream_.description.pipeline_latency);
  const auto sentBy = [&](std::size_t frame) {
    return localAt(stream_.frames[frame].time_s + latency_s);
  };
  for (;;) {
    const bool more = next_ < stream_.frames.size() && sentBy(next_) <= now;
    const auto first = under_way_.begin();
    // What an arrival changes at the server holds for the frames that it sends later.
    if (first != under_way_.end() && first->first <= now &&
        (!more || first->first <= sentBy(next_))) {
      const Arrival arrival = std::move(first->second);
      events.at(first->first);
      under_way_.erase(first);
      arrival(events);
    } else if (more) {
      send(next_++);
    } else {
      return;
    }
  }
}

}  // namespace hapticast::evaluate
