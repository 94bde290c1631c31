// SPDX-License-Identifier: MIT
// Bytes, time and error of slices beside what else could carry a relief, and what they add to the
// error of the force.
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "common/codec/height_codec.hpp"
#include "common/protocol/messages.hpp"
#include "tests/evaluate/accuracy/accuracy_parts.hpp"
#include "tests/evaluate/codec/codec_rivals.hpp"
#include "tests/evaluate/codec/codec_shapes.hpp"
#include "tests/evaluate/thread_time.hpp"
#include "tests/evaluate/topics.hpp"
#include "tests/support/coded.hpp"

namespace hapticast::evaluate {

namespace {

// The relief as a viewer gets it.
Relief throughSlices(const Relief& relief, const SliceSettings& settings, Coded& cost) {
  static thread_local HeightEncoder encoder;
  static thread_local HeightDecoder decoder;
  Relief out = Relief::blank(relief.rect);
  const double start_us = threadTime_us();
  const auto slices = encoder.encode(relief, settings);
  const double middle_us = threadTime_us();
  for (const SliceBytes& slice : slices) {
    const auto covered = decoder.decode(slice, out);
    if (!covered.ok()) throw std::runtime_error("a slice was refused: " + covered.error().message);
  }
  cost.decode_us = threadTime_us() - middle_us;
  cost.encode_us = middle_us - start_us;
  for (const SliceBytes& slice : slices) cost.bytes += slice.size();
  return out;
}

Coded sliced(const Relief& relief, const SliceSettings& settings) {
  Coded out;
  const Relief back = throughSlices(relief, settings, out);
  for (std::size_t i = 0; i < back.mask.size(); ++i) {
    if ((relief.mask[i] != 0) != (back.mask[i] != 0)) throw std::runtime_error("a mask changed");
    if (relief.mask[i] == 0) continue;
    out.error_mm =
        std::max(out.error_mm, std::abs(double(relief.height_mm[i]) - double(back.height_mm[i])));
  }
  return out;
}

// Of the frames: mean bytes, the least time (others work on the machine, too), the worst error.
Coded measured(const CodecShape& shape, const std::function<Coded(const Relief&)>& code, int runs) {
  Coded out;
  double bytes = 0.0;
  for (const Relief& relief : shape.frames) {
    Coded best = code(relief);
    for (int i = 1; i < runs; ++i) {
      const Coded again = code(relief);
      best.encode_us = std::min(best.encode_us, again.encode_us);
      best.decode_us = std::min(best.decode_us, again.decode_us);
    }
    bytes += double(best.bytes);
    out.encode_us += best.encode_us / double(shape.frames.size());
    out.decode_us += best.decode_us / double(shape.frames.size());
    out.error_mm = std::max(out.error_mm, best.error_mm);
  }
  out.bytes = static_cast<std::size_t>(std::lround(bytes / double(shape.frames.size())));
  return out;
}

std::string mm(double error_mm) { return text("%.3g mm", error_mm); }

void addRows(Report& report, const CodecShape& shape, const std::string& variant, const Coded& cost,
             double error_mm, bool is_default) {
  const std::string at = " at " + mm(error_mm);
  const std::string kind = shape.raw ? ", raw depth" : "";
  report.add({shape.name, "bytes" + at + kind, variant, double(cost.bytes), "bytes/frame",
              cost.encode_us, is_default, false});
  report.add({shape.name, "decode" + at + kind, variant, cost.decode_us, "us", cost.decode_us,
              is_default, false});
  report.add({shape.name, "worst pixel" + at + kind, variant, cost.error_mm, "mm", 0.0, is_default,
              false});
}

// Geometric means over shapes of bytes and decoding against JPEG-LS.
struct Ratio {
  double bytes = 0.0, decode = 0.0;
  int count = 0;

  void add(const Coded& ours, const Coded& theirs) {
    bytes += std::log(double(ours.bytes) / double(theirs.bytes));
    decode += std::log(ours.decode_us / theirs.decode_us);
    ++count;
  }
};

void addRatio(Report& report, const std::string& what, const std::string& at, const Ratio& ratio) {
  const auto add = [&](const char* stage, double sum) {
    report.add({what + text(" (%d shapes)", ratio.count), stage + at, "slices",
                std::exp(sum / ratio.count), "ratio"});
  };
  add("bytes over those of JPEG-LS", ratio.bytes);
  add("run time of decoding over that of JPEG-LS", ratio.decode);
}

void measureShapes(const Options& options, Report& report) {
  const auto shapes = codecShapes(options.quick, report);
  const int runs = options.quick ? 2 : 8;
  for (const double error_mm : {kDefaultHeightError_mm, 0.055}) {
    std::map<std::string, Ratio> ratios;
    for (const CodecShape& shape : shapes) {
      const Coded ours = measured(
          shape, [&](const Relief& relief) { return sliced(relief, {error_mm}); }, runs);
      addRows(report, shape, "slices", ours, error_mm, error_mm == kDefaultHeightError_mm);
      if (ours.error_mm > error_mm) throw std::runtime_error(shape.name + ": the bound is broken");
      for (const Rival& rival : codecRivals()) {
        const Coded theirs = measured(
            shape, [&](const Relief& relief) { return rival.code(relief, error_mm); }, runs);
        addRows(report, shape, rival.name, theirs, error_mm, false);
        if (rival.name != "JPEG-LS") continue;
        const std::string kind = shape.raw ? "Raw depth" : "Smoothed";
        ratios[kind].add(ours, theirs);
        ratios[kind + (shape.tuned ? ", shapes like those the codec was tuned on"
                                   : ", shapes it was not tuned on")]
            .add(ours, theirs);
      }
      const double bytes = double(ours.bytes);
      if (shape.name == "ball, Gaussian 3 px" && error_mm == kDefaultHeightError_mm)
        report.add(Goal{"ball of 45,000 px at 0.02 mm", "bytes", 2200, 1600, bytes});
      if (shape.name == "ball, Gaussian 3 px" && error_mm != kDefaultHeightError_mm)
        report.add(Goal{"ball of 45,000 px at 0.055 mm", "bytes", 1300, 1000, bytes});
    }
    for (const auto& [what, ratio] : ratios) addRatio(report, what, " at " + mm(error_mm), ratio);
  }
}

// A stream whose reliefs went through slices.
Stream sliced(const Stream& stream, const SliceSettings& settings) {
  Stream out = stream;
  FrameCoder coder;
  for (Stream::Bytes& bytes : out.frames) {
    auto decoded = decode(*bytes.message);
    const auto& frame = std::get<CodedFrame>(decoded.value());
    HapticFrame plain{frame.epoch, frame.id, frame.media_time, {}};
    for (const CodedObject& object : frame.objects) {
      std::shared_ptr<const Relief> relief;
      if (object.relief)
        relief = std::make_shared<const Relief>(testing::decodedRelief(*object.relief));
      plain.objects.push_back(replaceRelief(object, relief));
    }
    bytes.message = encodeShared(coder.code(plain, settings));
  }
  return out;
}

std::string formatName(const SliceSettings& settings) {
  const SliceSettings plain;
  const std::string coarse = "/16 coarse";
  return mm(settings.error_mm) + (settings.coarse_sixteenths == plain.coarse_sixteenths
                                      ? std::string()
                                      : ", " + std::to_string(settings.coarse_sixteenths) + coarse);
}

std::vector<SliceSettings> forceSettings(bool quick) {
  if (quick) return {{}, {0.055}};
  return {{},         {0.005}, {0.01},     {0.015}, {0.02, 6},   {0.02, 8}, {0.02, 12},
          {0.02, 16}, {0.03},  {0.055, 8}, {0.055}, {0.055, 16}, {0.2}};
}

// Error that slices add to that of the force, in points of its relative RMS.
void measureForce(const Options& options, Report& report) {
  struct Touched {
    TouchScene scene;
    double reach_mm;
  };
  double worst = 0.0;
  for (const Touched& touched : {Touched{stillSphere(), 12.0}, Touched{stillEllipsoid(), 10.0},
                                 Touched{stillSinusoid(), 18.0}}) {
    StreamKind kind;
    kind.longest_s = options.quick ? 6.0 : 20.0;
    const Stream stream = makeStream(touched.scene, kind);
    const Hand hand = slidingHand(touched.scene, touched.reach_mm);
    const auto error = [&](const Stream& trace) {
      return 100.0 * relativeError(renderTrace(trace, defaultVariant(), hand).ticks);
    };
    const double without = error(stream);
    for (const SliceSettings& settings : forceSettings(options.quick)) {
      const double added = error(sliced(stream, settings)) - without;
      const bool is_default = settings == SliceSettings{};
      report.add({touched.scene.name, "added_force", formatName(settings), added, "points", 0.0,
                  is_default, false});
      if (is_default) worst = std::max(worst, added);
    }
  }
  report.add(
      Goal{"force error added at 0.02 mm, worst of three surfaces", "points", 0.5, 0.1, worst});
}

}  // namespace

static void evaluateCodec(const Options& options) {
  Report report("codec", options);
  measureForce(options, report);
  measureShapes(options, report);
  report.write();
}

const RegisteredTopic kCodecTopic(
    "codec",
    {.about = "heights on the wire: bytes, time and error beside other codecs",
     .method =
         "Bytes, run times and errors of heights on the wire as slices, beside JPEG-LS (CharLS), "
         "PNG, zstd and plain 16 bit at the same bound on the error of every pixel. The truth is "
         "the relief before it was coded, and for the force the exact one under a sliding hand. "
         "The others carry the object's rectangle. Slices carry the mask, too.",
     .evaluate = evaluateCodec});

}  // namespace hapticast::evaluate
