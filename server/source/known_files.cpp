// SPDX-License-Identifier: MIT
#include "server/source/known_files.hpp"

#include <fmt/core.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "common/text.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace {

using namespace std::string_view_literals;

// Both make a folder with an MCAP file. {} is the file.
constexpr const char* kConvertBag =
    "; convert it (pip install rosbags; rosbags-convert --src {0} --dst {1} --dst-storage mcap), "
    "and "
    "use the folder {1}";
constexpr const char* kConvertDatabase =
    "; convert it (echo 'output_bags: [{{uri: {1}, storage_id: mcap, all: true}}]' > out.yaml; "
    "ros2 "
    "bag convert -i {0} -o out.yaml), and use the folder {1}";

struct KnownFile {
  std::string_view begin;   ///< first bytes of the file
  std::string_view ending;  ///< ending of its name; empty: any
  const char* what;
  const char* remedy;  ///< {0} is the file, {1} the name of a folder beside it
};

constexpr std::array kKnownFiles{
    KnownFile{"#ROSBAG V", "", "is a bag of ROS 1", kConvertBag},
    KnownFile{"SQLite format 3", "", "is a ROS 2 bag of SQLite", kConvertDatabase},
    KnownFile{"PK\x03\x04", ".r3d", "is a capture of Record3D",
              "; export it there as an RGBD video, and use --layout side-by-side --depth-code hue"},
    KnownFile{"PK\x03\x04", ".npz", "has depth only",
              "; name the colour video too: COLOR,FILE.npz"},
    KnownFile{"PK\x03\x04", "", "is an archive", "; unpack it, then use its folder"},
    KnownFile{"\x1F\x8B", "", "is an archive", "; unpack it, then use its folder"},
    KnownFile{"7z\xBC\xAF\x27\x1C", "", "is an archive", "; unpack it, then use its folder"},
    KnownFile{"\xFD"
              "7zXZ\0"sv,
              "", "is an archive", "; unpack it, then use its folder"},
    KnownFile{"\x28\xB5\x2F\xFD", "", "is compressed",
              "; unpack it (unzstd FILE), then use FILE.mcap"},
    KnownFile{"\x93NUMPY", "", "has depth only", "; name the colour video too: COLOR,FILE.npy"},
    KnownFile{"\x89PNG", "", "is one picture", "; use a folder with rgb/ and depth/"},
    KnownFile{"\xFF\xD8\xFF", "", "is one picture", "; use a folder with rgb/ and depth/"},
};

/// Place and text of the mark of a tar archive (POSIX ustar).
constexpr std::size_t kTarMark_bytes = 257;

}  // namespace

void refuseKnownFile(const std::string& file) {
  std::array<char, 512> bytes{};
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), std::ssize(bytes));
  const std::string_view head(bytes.data(), static_cast<std::size_t>(in.gcount()));
  for (const KnownFile& known : kKnownFiles) {
    if (head.starts_with(known.begin) && (known.ending.empty() || hasEnding(file, known.ending)))
      throw SourceError(
          fmt::format("{}: {}{}", file, known.what,
                      fmt::format(fmt::runtime(known.remedy), file,
                                  std::filesystem::path(file).stem().string() + "_mcap")));
  }
  const bool tar = head.size() > kTarMark_bytes && head.substr(kTarMark_bytes).starts_with("ustar");
  if (tar || hasEnding(file, ".zip") || hasEnding(file, ".tgz"))
    throw SourceError(file + ": is an archive; unpack it, then use its folder");
}

}  // namespace hapticast::server
