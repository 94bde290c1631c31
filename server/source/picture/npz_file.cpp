// SPDX-License-Identifier: MIT
#include "server/source/picture/npz_file.hpp"

#include <zip.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "common/text.hpp"

namespace hapticast::server {

namespace {

/// Returns the problem with its remedy.
std::string askToSaveAnew(std::string problem) {
  return problem.append("; save it anew (numpy: np.savez_compressed)");
}

StreamResult describeDamage() { return {nullptr, askToSaveAnew("is cut off or damaged")}; }

struct Close {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_file_t* member) const { (void)zip_fclose(member); }
};
using Archive = std::unique_ptr<zip_t, Close>;
using Member = std::unique_ptr<zip_file_t, Close>;

class MemberStream final : public ByteStream {
 public:
  MemberStream(Archive archive, const zip_stat_t& facts, Member member)
      : archive_(std::move(archive)), facts_(facts), member_(std::move(member)) {}

  [[nodiscard]] std::uint64_t size() const override { return facts_.size; }
  [[nodiscard]] bool read(std::span<std::uint8_t> target) override;
  [[nodiscard]] bool seek(std::uint64_t offset) override;
  [[nodiscard]] bool seeksBackwards() const override { return facts_.comp_method == ZIP_CM_STORE; }

 private:
  /// Closes the member after a failure. Returns false.
  bool fail();

  Archive archive_;
  zip_stat_t facts_;
  Member member_;  // null after a failure
  std::uint64_t at_ = 0;
  // Where a read has failed. A deflated member cannot be read from here on.
  std::uint64_t broken_at_ = std::numeric_limits<std::uint64_t>::max();
};

bool MemberStream::read(std::span<std::uint8_t> target) {
  while (!target.empty()) {
    const zip_int64_t count = member_ ? zip_fread(member_.get(), target.data(), target.size()) : -1;
    if (count <= 0) return fail();
    at_ += static_cast<std::uint64_t>(count);
    target = target.subspan(static_cast<std::size_t>(count));
  }
  if (at_ != facts_.size) return true;
  // A read at the end checks the sum of all bytes, unless a stored member was read in another
  // order. A wrong sum stays wrong.
  std::uint8_t none = 0;
  return (at_ < broken_at_ && zip_fread(member_.get(), &none, 1) == 0) || fail();
}

bool MemberStream::fail() {
  broken_at_ = std::min(broken_at_, at_);
  member_.reset();
  return false;
}

bool MemberStream::seek(std::uint64_t offset) {
  if (offset >= broken_at_ && !seeksBackwards()) return false;
  if (!member_ || (offset < at_ && !seeksBackwards())) {
    member_.reset(zip_fopen_index(archive_.get(), facts_.index, 0));
    at_ = 0;
  }
  if (seeksBackwards() && member_) {
    at_ = offset;
    return zip_fseek(member_.get(), static_cast<zip_int64_t>(offset), SEEK_SET) == 0 || fail();
  }
  std::array<std::uint8_t, 65'536> skipped{};
  while (at_ < offset) {
    const std::uint64_t count = std::min<std::uint64_t>(offset - at_, skipped.size());
    if (!read(std::span(skipped).first(static_cast<std::size_t>(count)))) return false;
  }
  return true;
}

/// Returns the member with the depth. Returns the problem, or "".
std::string findDepth(zip_t* archive, zip_uint64_t& index) {
  constexpr zip_int64_t kMostMembers = 1000;
  std::vector<std::string> names;
  std::vector<zip_uint64_t> members;
  const zip_int64_t count = zip_get_num_entries(archive, 0);
  if (count > kMostMembers) return "has more than 1000 members; save the depth alone";
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* const name = zip_get_name(archive, static_cast<zip_uint64_t>(i), 0);
    if (name == nullptr || !hasEnding(name, ".npy")) continue;
    members.push_back(static_cast<zip_uint64_t>(i));
    names.emplace_back(name, std::string_view(name).size() - 4);
  }
  if (names.empty()) return askToSaveAnew("has no array");
  auto found = names.begin();
  if (names.size() > 1) found = std::find(names.begin(), names.end(), "depths");
  if (found == names.end()) found = std::find(names.begin(), names.end(), "depth");
  if (found == names.end())
    return "has the arrays " + sanitizeUtf8(join(names, ", "), 200) +
           ", but none has the name depths or depth; save the depth under this name";
  index = members[static_cast<std::size_t>(found - names.begin())];
  return "";
}

StreamResult openMember(Archive archive) {
  if (!archive) return describeDamage();
  zip_uint64_t index = 0;
  if (std::string problem = findDepth(archive.get(), index); !problem.empty())
    return {nullptr, problem};
  zip_stat_t facts{};
  constexpr zip_uint64_t kNeeded = ZIP_STAT_SIZE | ZIP_STAT_COMP_METHOD | ZIP_STAT_INDEX;
  if (zip_stat_index(archive.get(), index, 0, &facts) != 0 || (facts.valid & kNeeded) != kNeeded)
    return describeDamage();
  if (facts.comp_method != ZIP_CM_STORE && facts.comp_method != ZIP_CM_DEFLATE)
    return {nullptr,
            "is compressed in another way than NumPy does; save it anew (numpy: "
            "np.savez_compressed)"};
  Member member(zip_fopen_index(archive.get(), index, 0));
  if (!member)
    return {nullptr, "has an array that cannot be opened (" +
                         sanitizeUtf8(zip_strerror(archive.get()), 100) + "); save it anew"};
  return {std::make_unique<MemberStream>(std::move(archive), facts, std::move(member)), ""};
}

}  // namespace

bool isZip(std::span<const std::uint8_t> bytes) {
  const std::string_view text = toText(bytes);
  return text.starts_with("PK\x03\x04") || text.starts_with("PK\x05\x06");
}

StreamResult openNpz(const std::filesystem::path& file) {
  const StreamResult bytes = openFileStream(file);
  if (!bytes.stream) return {nullptr, bytes.problem};
  std::array<std::uint8_t, 4> begin{};
  if (!bytes.stream->read(begin) || !isZip(begin))
    return {nullptr, askToSaveAnew("is not an NPZ file")};
  return openMember(Archive(zip_open(file.c_str(), ZIP_RDONLY, nullptr)));
}

StreamResult openNpz(std::span<const std::uint8_t> bytes) {
  zip_source_t* const source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, nullptr);
  if (source == nullptr) return describeDamage();
  Archive archive(zip_open_from_source(source, ZIP_RDONLY, nullptr));
  if (!archive) zip_source_free(source);  // else it belongs to the archive
  return openMember(std::move(archive));
}

}  // namespace hapticast::server
