// SPDX-License-Identifier: MIT
#include "server/show/sinks.hpp"

#include <spdlog/spdlog.h>

#include <memory>
#include <utility>

#include "server/stream/signing_key_file.hpp"

namespace hapticast::server {

namespace {

/// Returns the keys of origins that this one makes room for: all, unless the user named keys or has
/// a key of its own.
std::vector<KeyBytes> trustedOrigins(const Settings& settings, const FrameSigner& signer) {
  std::vector<KeyBytes> keys = settings.origin_keys;
  if (!keys.empty() || !settings.signing_key_file.empty())
    keys.push_back(signer.identity().verifying_key);
  return keys;
}

}  // namespace

Sinks::Sinks(const Settings& settings, const Clock& clock, const MediaClock& media_clock,
             const StreamDescription& description)
    : signer_(settings.signing_key_file.empty() ? SigningKey()
                                                : loadSigningKey(settings.signing_key_file),
              settings.tls.wanted() ? std::make_unique<DatagramSealer>(clock) : nullptr),
      service_(settings, clock, media_clock, description,
               settings.command == Command::kRelay ? StreamIdentity{} : signer_.identity()) {
  service_.broadcaster().onRemoved([this] { signer_.revokeKey(); });
  // Viewers of relays need the key: a relay could show another one.
  if (settings.publish || !settings.signing_key_file.empty())
    spdlog::info("origin key: {}", toHex(signer_.identity().verifying_key));
  if (settings.publish)
    relay_.emplace(*settings.publish, settings.nats, clock, media_clock, signer_,
                   trustedOrigins(settings, signer_));
  if (settings.outputs.wanted()) recorder_.emplace(settings.outputs, media_clock);
  if (settings.http) signer_.measure(clock);
}

std::optional<RelayCounts> Sinks::relayCounts() const {
  return relay_ ? std::optional(relay_->counts()) : std::nullopt;
}

std::vector<StreamSink*> Sinks::all() {
  std::vector<StreamSink*> sinks{&service_.broadcaster()};
  if (relay_) sinks.push_back(&*relay_);
  if (recorder_) sinks.push_back(&*recorder_);
  return sinks;
}

}  // namespace hapticast::server
