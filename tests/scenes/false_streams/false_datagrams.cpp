// SPDX-License-Identifier: MIT
// False streams with wrong datagram headers, or with the payload of another datagram. Every one
// of them is signed, because a malicious server has the key.
#include <stdexcept>
#include <utility>

#include "tests/scenes/false_streams/false_stream_parts.hpp"
#include "tests/support/coded.hpp"

namespace hapticast::testing {

namespace {

using Part = OutgoingDatagrams::Part;

/// A plateau that needs several datagrams, the same in every frame, so that it is coded once.
std::shared_ptr<const Relief> bumpy(double height_mm) {
  static std::map<double, std::shared_ptr<const Relief>> made;
  auto& relief = made[height_mm];
  if (!relief) {
    relief = shape([=](double x, double y) {
      return height_mm + 0.3 * std::sin(23.0 * x * y) + 0.1 * std::cos(90.0 * x);
    });
  }
  return relief;
}

void setBumps(OutgoingFrame& t) { t.setRelief(bumpy(10.0)); }

/// Its parts, as if another frame of that height stood behind the same header.
std::vector<Part> partsAt(const OutgoingDatagrams& t, double height_mm) {
  CodedFrame other = t.frame;
  HapticObject object;
  object.relief = bumpy(height_mm);
  static std::map<double, std::shared_ptr<const CodedRelief>> coded_reliefs;
  auto& relief = coded_reliefs[height_mm];
  if (!relief) relief = coded(object).relief;
  other.objects.front().relief = relief;
  return OutgoingDatagrams::partsOf(other);
}

/// From the 30th frame on.
template <class Change>
auto parted(Change change) {
  return [change](OutgoingDatagrams& t) {
    if (t.n < 30) return;
    if (t.parts.size() < 4) throw std::logic_error("the plateau has to be in several datagrams");
    change(t);
  };
}
template <class Change>
auto headed(Change change) {
  return parted([change](OutgoingDatagrams& t) {
    for (Part& part : t.parts) change(part.header, t);
  });
}

FalseStream false_stream(const char* name, Verdict verdict,
                         std::function<void(OutgoingDatagrams&)> alter_datagrams,
                         bool on_tcp = false) {
  return {.name = std::string("datagram_") + name,
          .hand = kHold,
          .verdict = verdict,
          .alter = setBumps,
          .alter_datagrams = std::move(alter_datagrams),
          .on_tcp = on_tcp};
}

// --- how many parts, and which

FalseStreams counts() {
  return {
      false_stream("honest", kHarmless, [](OutgoingDatagrams&) {}),
      false_stream("parts_differ", kHarmless,
                   headed([](DatagramHeader& header, OutgoingDatagrams&) {
                     header.parts = static_cast<std::uint16_t>(header.parts + header.part % 2);
                   })),
      false_stream("parts_65535", kHarmless, headed([](DatagramHeader& header, OutgoingDatagrams&) {
                     header.parts = 65'535;
                   })),
      false_stream("part_65534", kHarmless, headed([](DatagramHeader& header, OutgoingDatagrams&) {
                     header.parts = 65'535;
                     header.part = static_cast<std::uint16_t>(65'534 - header.part);
                   })),
      false_stream("part_beyond", kRefused, headed([](DatagramHeader& header, OutgoingDatagrams&) {
                     header.part = static_cast<std::uint16_t>(header.part + header.parts);
                   })),
      false_stream("parts_too_few", kRefused,
                   headed([](DatagramHeader& header, OutgoingDatagrams&) { header.parts = 2; })),
      false_stream("half_sent", kHarmless,
                   parted([](OutgoingDatagrams& t) { t.parts.resize(t.parts.size() / 2); })),
      false_stream("only_heads", kHarmless,
                   parted([](OutgoingDatagrams& t) { t.parts.resize(1); })),
      false_stream("never_heads", kHarmless,
                   parted([](OutgoingDatagrams& t) { t.parts.erase(t.parts.begin()); })),
      false_stream("probes", kHarmless, parted([](OutgoingDatagrams& t) {
                     const Part probe{{t.parts.front().header.stream, 0, 0, {}, 0, 0},
                                      Bytes(kMostPieceBytes + kSealBytes)};
                     t.parts.insert(t.parts.begin(), 150, probe);
                   })),
      false_stream("short_probes", kRefused, parted([](OutgoingDatagrams& t) {
                     t.parts.push_back({{t.parts.front().header.stream, 0, 0, {}, 0, 0}, {}});
                   })),
      false_stream(
          "another_stream", kRefused,
          headed([](DatagramHeader& header, OutgoingDatagrams&) { header.stream += header.part; })),
  };
}

// --- ids, epochs, times

FalseStreams places() {
  constexpr std::uint64_t kJump = 2400;  // as far as ids may go from one to the next
  return {
      false_stream(
          "times_differ", kHarmless, headed([](DatagramHeader& header, OutgoingDatagrams& t) {
            header.media_time += fromSeconds(std::uniform_real_distribution(-1.0, 1.0)(t.random));
          })),
      false_stream("times_jump", kHarmless,
                   headed([](DatagramHeader& header, OutgoingDatagrams& t) {
                     header.media_time += fromSeconds(t.n % 2 == 0 ? 1.0 : -1.0);
                   })),
      false_stream("times_30_y_differ", kHarmless,
                   headed([](DatagramHeader& header, OutgoingDatagrams&) {
                     header.media_time += fromSeconds(header.part % 2 == 0 ? 9.4e8 : -9.4e8);
                   })),
      false_stream("times_292_y", kRefused, headed([](DatagramHeader& header, OutgoingDatagrams&) {
                     header.media_time = MediaTime(Duration::max());
                   })),
      false_stream("times_against_tcp", kHarmless,
                   headed([](DatagramHeader& header, OutgoingDatagrams&) {
                     header.frame += 1;  // before TCP brings it
                     header.media_time += fromSeconds(1.0);
                   }),
                   true),
      false_stream("epoch_differs", kHarmless,
                   headed([](DatagramHeader& header, OutgoingDatagrams& t) {
                     header.epoch = static_cast<std::uint32_t>(t.random());
                   })),
      false_stream("epoch_of_each_frame", kLimited,
                   headed([](DatagramHeader& header, OutgoingDatagrams& t) {
                     header.epoch = static_cast<std::uint32_t>(t.n);
                   })),
      false_stream("epoch_against_tcp", kHarmless,
                   headed([](DatagramHeader& header, OutgoingDatagrams& t) {
                     header.frame += 1;
                     header.epoch = static_cast<std::uint32_t>(t.n);
                   }),
                   true),
      false_stream("ids_race", kHarmless, headed([=](DatagramHeader& header, OutgoingDatagrams& t) {
                     header.frame = (t.n - 28) * kJump;
                   })),
      false_stream("ids_race_each", kHarmless,
                   headed([=](DatagramHeader& header, OutgoingDatagrams& t) {
                     header.frame = ((t.n - 28) * t.parts.size() + header.part) * kJump;
                   })),
      false_stream("ids_huge", kHarmless, headed([](DatagramHeader& header, OutgoingDatagrams& t) {
                     header.frame = t.random();
                   })),
      false_stream(
          "ids_max_first", kHarmless,
          [](OutgoingDatagrams& t) {
            if (t.n > 0) return;
            for (Part& part : t.parts) part.header.frame = ~std::uint64_t{0};
          },
          true),
      false_stream("ids_wrap", kHarmless,
                   [](OutgoingDatagrams& t) {
                     for (Part& part : t.parts) part.header.frame += ~std::uint64_t{40};
                   }),
      false_stream("ids_backwards", kHarmless,
                   [](OutgoingDatagrams& t) {
                     for (Part& part : t.parts) part.header.frame = 1'000'000 - t.n;
                   }),
      false_stream("ids_late", kHarmless, headed([](DatagramHeader& header, OutgoingDatagrams& t) {
                     header.frame -= header.part == 0 ? 0 : t.random() % 30;
                   })),
      false_stream("ids_ahead_of_tcp", kHarmless,
                   headed([](DatagramHeader& header, OutgoingDatagrams&) {
                     header.frame += 2000;  // the client then drops those of TCP as late
                   }),
                   true),
  };
}

// --- payloads that do not belong there

FalseStreams payloads() {
  return {
      false_stream("slices_of_another_frame", kHarmless, parted([](OutgoingDatagrams& t) {
                     const std::vector<Part> others = partsAt(t, 20.0);
                     for (std::size_t i = 1; i < std::min(others.size(), t.parts.size()); i += 2)
                       t.parts[i].payload = others[i].payload;
                   })),
      false_stream("slices_twice", kRefused,
                   parted([](OutgoingDatagrams& t) { t.parts[2].payload = t.parts[1].payload; })),
      false_stream("copies_contradict", kHarmless, parted([](OutgoingDatagrams& t) {
                     for (const Part& part : partsAt(t, 20.0)) t.parts.push_back(part);
                   })),
      false_stream("copies_contradict_in_turns", kLimited, parted([](OutgoingDatagrams& t) {
                     std::vector<Part> others =
                         partsAt(t, 10.0 + 10.0 * static_cast<double>(t.n % 2));
                     others.insert(others.end(), t.parts.begin(), t.parts.end());
                     t.parts = std::move(others);
                   })),
      false_stream("two_heads", kRefused,
                   parted([](OutgoingDatagrams& t) { t.parts[1].payload = t.parts[0].payload; })),
      false_stream("head_of_another", kHarmless, parted([](OutgoingDatagrams& t) {
                     CodedFrame other = t.frame;
                     other.objects.front().id = 2;
                     t.parts.front().payload = OutgoingDatagrams::partsOf(other).front().payload;
                   })),
      false_stream("17_objects", kRefused, parted([](OutgoingDatagrams& t) {
                     for (std::size_t i = 1; i < t.parts.size(); ++i) {
                       CodedFrame other = t.frame;
                       other.objects.assign(16, other.objects.front());
                       for (CodedObject& each : other.objects) {
                         each.id = static_cast<std::uint32_t>(i * 100 + other.objects.size());
                         each.relief = nullptr;
                         each.changed_in_frame = 0;
                         each.id += static_cast<std::uint32_t>(&each - other.objects.data());
                       }
                       t.parts[i].payload = OutgoingDatagrams::partsOf(other).front().payload;
                     }
                   })),
      false_stream("heads_to_come", kHarmless, parted([](OutgoingDatagrams& t) {
                     // The field behind the objects: sixteen of them, of which one comes.
                     t.parts.front().payload.insert(t.parts.front().payload.end(), {0x28, 0x10});
                   })),
      false_stream("noise", kRefused, parted([](OutgoingDatagrams& t) {
                     for (Part& part : t.parts) {
                       for (auto& byte : part.payload) byte = static_cast<std::uint8_t>(t.random());
                     }
                   })),
      false_stream("empty", kHarmless, parted([](OutgoingDatagrams& t) {
                     for (Part& part : t.parts) part.payload.clear();
                   })),
  };
}

}  // namespace

FalseStreams datagrams() {
  FalseStreams all = counts();
  for (FalseStream& each : places()) all.push_back(std::move(each));
  for (FalseStream& each : payloads()) all.push_back(std::move(each));
  return all;
}

}  // namespace hapticast::testing
