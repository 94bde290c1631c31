// SPDX-License-Identifier: MIT
#include "client/net/udp/datagram_key_ring.hpp"

#include <algorithm>

namespace hapticast::client {

bool CounterWindow::has(std::uint64_t counter) const noexcept {
  if (counter > newest_) return false;
  if (newest_ - counter >= kCounters) return true;
  return (words_[counter / kWordBits % kWords] >> (counter % kWordBits) & 1U) != 0;
}

void CounterWindow::add(std::uint64_t counter) noexcept {
  const std::uint64_t word = counter / kWordBits, newest_word = newest_ / kWordBits;
  if (counter > newest_) {
    const std::uint64_t steps = std::min(word - newest_word, kWords);
    for (std::uint64_t i = 1; i <= steps; ++i) words_[(newest_word + i) % kWords] = 0;
    newest_ = counter;
  }
  words_[word % kWords] |= std::uint64_t{1} << (counter % kWordBits);
}

void DatagramKeyRing::begin(const std::optional<DatagramKey>& key) {
  const auto same = [&key](const Entry& each) {
    return key && each.of.id == key->id && each.of.bytes == key->bytes;
  };
  if (!keys_.empty() && same(keys_.back())) {
    keys_.erase(keys_.begin(), keys_.end() - 1);
    return;
  }
  keys_.clear();
  if (key) keys_.emplace_back(*key);
}

void DatagramKeyRing::add(const DatagramKey& key, LocalTime now) {
  std::erase_if(keys_, [&key](const Entry& each) { return each.of.id == key.id; });
  if (keys_.size() >= kMostKeys) keys_.erase(keys_.begin());
  const LocalTime expires = now + key.grace;
  for (Entry& each : keys_) each.expires = std::min(each.expires.value_or(expires), expires);
  keys_.emplace_back(key);
}

std::size_t DatagramKeyRing::find(std::uint8_t id) const {
  std::size_t at = 0;
  while (at < keys_.size() && keys_[at].of.id != id) ++at;
  return at;
}

DatagramKeyRing::Check DatagramKeyRing::check(const Datagram& datagram, LocalTime now) const {
  if (datagram.header.probe()) return Check::kOpenable;  // never sealed
  if (datagram.key_id == kPlainKeyId) return sealed() ? Check::kNoKey : Check::kOpenable;
  const std::size_t at = find(datagram.key_id);
  if (at == keys_.size()) return Check::kNoKey;
  const Entry& key = keys_[at];
  if (key.expires && now >= *key.expires) return Check::kNoKey;
  return key.window.has(datagram.counter) ? Check::kRepeated : Check::kOpenable;
}

bool DatagramKeyRing::open(Datagram& datagram) {
  if (datagram.key_id == kPlainKeyId) return true;
  Entry& key = keys_[find(datagram.key_id)];
  const auto payload = std::span(payload_).first(datagram.sealed.size() - kSealTagBytes);
  if (!key.opening.open(datagram.counter, datagram.readable, datagram.sealed, payload))
    return false;
  key.window.add(datagram.counter);
  datagram.payload = payload;
  return true;
}

}  // namespace hapticast::client
