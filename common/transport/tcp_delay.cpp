// SPDX-License-Identifier: MIT
#include "common/transport/tcp_delay.hpp"

#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>

namespace hapticast {

Duration estimateTcpDelay(int socket, std::size_t bytes) noexcept {
  tcp_info info{};
  socklen_t size = sizeof info;
  if (::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 || info.tcpi_min_rtt == 0)
    return Duration{0};
  const double segment_bytes = info.tcpi_snd_mss;
  const double window_B_s = 1e6 * info.tcpi_snd_cwnd * segment_bytes / info.tcpi_min_rtt;
  const auto measured_B_s = static_cast<double>(info.tcpi_delivery_rate);
  const double rate_B_s = info.tcpi_delivery_rate_app_limited != 0 || measured_B_s <= 0.0
                              ? std::max(measured_B_s, window_B_s)
                              : measured_B_s;
  if (rate_B_s <= 0.0) return Duration{0};
  const double waiting_bytes = info.tcpi_unacked * segment_bytes + info.tcpi_notsent_bytes;
  return fromSeconds((waiting_bytes + static_cast<double>(bytes)) / rate_B_s);
}

}  // namespace hapticast
