// SPDX-License-Identifier: MIT
#include "server/stream/datagram_sealer.hpp"

#include <utility>

namespace hapticast::server {

DatagramSealer::DatagramSealer(const Clock& clock)
    : clock_(clock), present_(1), used_since_(clock.now()), last_id_(present_.id()) {}

SealingKey DatagramSealer::makeKey() {
  last_id_ = last_id_ == 255 ? std::uint8_t{1} : static_cast<std::uint8_t>(last_id_ + 1);
  return SealingKey(last_id_);
}

void DatagramSealer::revoke() {
  const std::lock_guard lock(mutex_);
  revoked_ = true;
}

std::optional<DatagramKey> DatagramSealer::rotate() {
  const LocalTime now = clock_.now();
  std::unique_lock lock(mutex_);
  const bool revoked = std::exchange(revoked_, false);
  lock.unlock();
  if (revoked) {
    next_.reset();  // the revoked viewers may have it
    present_ = makeKey();
    used_since_ = now;
    return DatagramKey{present_.id(), present_.bytes(), kRevokedGrace};
  }
  if (next_ && now >= use_next_at_) {
    present_ = std::move(*next_);
    next_.reset();
    used_since_ = now;
  }
  if (next_ || now - used_since_ < kKeyLife) return std::nullopt;
  next_ = makeKey();
  use_next_at_ = now + kAnnouncedBefore;
  return DatagramKey{next_->id(), next_->bytes(), kGrace};
}

}  // namespace hapticast::server
