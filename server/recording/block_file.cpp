#include "server/recording/block_file.h"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <stdexcept>

namespace wobble::recording {
namespace {

constexpr std::array<std::uint8_t, 8> kMark{'w', 'o', 'b', 'r', 'e', 'c', '\r', '\n'};
constexpr std::size_t kHeadBytes = kMark.size() + sizeof kFormatVersion;
constexpr int kCompression = 3;  // zstd's default; more takes twice the time for a tenth

struct BlockHead {
  std::uint8_t kind = 0;
  std::array<std::uint8_t, 3> zeros{};
  std::uint32_t size = 0;
  std::uint32_t packedSize = 0;
  std::uint32_t checksum = 0;
};
static_assert(sizeof(BlockHead) == 16);
constexpr std::size_t kCheckedHeadBytes = 12;

std::uint32_t FindChecksum(const BlockHead& head, std::span<const std::uint8_t> packed) {
  const uLong ofHead = crc32_z(0, reinterpret_cast<const Bytef*>(&head), kCheckedHeadBytes);
  return static_cast<std::uint32_t>(crc32_z(ofHead, packed.data(), packed.size()));
}

bool IsKind(std::uint8_t kind) {
  return kind >= static_cast<std::uint8_t>(BlockKind::kHead) &&
         kind <= static_cast<std::uint8_t>(BlockKind::kCheckpoint);
}

}  // namespace

const char* Name(BlockKind kind) {
  switch (kind) {
    case BlockKind::kHead:
      return "head";
    case BlockKind::kSecond:
      return "second";
    case BlockKind::kKeyframe:
      return "keyframe";
    case BlockKind::kEnd:
      return "end";
    case BlockKind::kCheckpoint:
      return "checkpoint";
  }
  return "";
}

Bytes MakeFileHead() {
  Bytes head(kMark.begin(), kMark.end());
  head.resize(kHeadBytes);
  std::memcpy(head.data() + kMark.size(), &kFormatVersion, sizeof kFormatVersion);
  return head;
}

Bytes PackBlock(BlockKind kind, std::span<const std::uint8_t> bytes) {
  assert(bytes.size() <= kMaxBlockBytes);
  Bytes block(sizeof(BlockHead) + ZSTD_compressBound(bytes.size()));
  const std::size_t packed = ZSTD_compress(block.data() + sizeof(BlockHead), block.size() - sizeof(BlockHead),
                                           bytes.data(), bytes.size(), kCompression);
  if (ZSTD_isError(packed) != 0) throw std::runtime_error(ZSTD_getErrorName(packed));  // no memory
  block.resize(sizeof(BlockHead) + packed);
  BlockHead head{.kind = static_cast<std::uint8_t>(kind),
                 .zeros = {},
                 .size = static_cast<std::uint32_t>(bytes.size()),
                 .packedSize = static_cast<std::uint32_t>(packed),
                 .checksum = 0};
  head.checksum = FindChecksum(head, std::span(block).subspan(sizeof head));
  std::memcpy(block.data(), &head, sizeof head);
  return block;
}

std::string WriteWhole(const std::filesystem::path& path, const Bytes& bytes) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (file < 0) return std::strerror(errno);
  std::string error;
  for (std::size_t done = 0; done < bytes.size() && error.empty();) {
    const ssize_t written = write(file, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) error = std::strerror(errno);
    done += static_cast<std::size_t>(std::max<ssize_t>(written, 0));
  }
  // Before the rename, or the name could outlive a power cut without the bytes.
  if (error.empty() && fdatasync(file) != 0) error = std::strerror(errno);
  close(file);
  return error;
}

bool IsBlockFile(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  std::array<std::uint8_t, kMark.size()> mark{};
  std::FILE* const file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return false;
  const bool isRead = std::fread(mark.data(), 1, mark.size(), file) == mark.size();
  std::fclose(file);
  return isRead && mark == kMark;
}

std::optional<Block> UnpackBlock(std::span<const std::uint8_t> packed) {
  BlockHead head;
  if (packed.size() < sizeof head) return {};
  std::memcpy(&head, packed.data(), sizeof head);
  const auto content = packed.subspan(sizeof head);
  if (!IsKind(head.kind) || head.size > kMaxBlockBytes || head.packedSize != content.size()) return {};
  if (FindChecksum(head, content) != head.checksum) return {};
  Block block{.kind = static_cast<BlockKind>(head.kind), .bytes = Bytes(head.size)};
  const std::size_t unpacked = ZSTD_decompress(block.bytes.data(), block.bytes.size(), content.data(), content.size());
  return ZSTD_isError(unpacked) == 0 && unpacked == head.size ? std::optional(std::move(block)) : std::nullopt;
}

std::string BlockReader::Open(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) return "does not exist";
  if (!std::filesystem::is_regular_file(status)) return "is no regular file";
  m_file.reset(std::fopen(path.c_str(), "rb"));
  if (m_file == nullptr) return "cannot be read";
  m_size = std::filesystem::file_size(path, error);
  const auto head = ReadAt(0, kHeadBytes);
  if (!head || !std::equal(kMark.begin(), kMark.end(), head->begin())) return "is not of wobble's format";
  std::uint32_t version = 0;
  std::memcpy(&version, head->data() + kMark.size(), sizeof version);
  if (version != kFormatVersion) {
    return "is of format " + std::to_string(version) + "; this program reads format " + std::to_string(kFormatVersion);
  }
  m_offset = kHeadBytes;
  m_fault.clear();
  return {};
}

std::optional<Bytes> BlockReader::ReadAt(std::uint64_t offset, std::size_t count) {
  if (offset > m_size || count > m_size - offset) return {};
  Bytes bytes(count);
  if (std::fseek(m_file.get(), static_cast<long>(offset), SEEK_SET) != 0) return {};
  if (std::fread(bytes.data(), 1, count, m_file.get()) != count) return {};
  return bytes;
}

std::optional<Block> BlockReader::Fail(const std::string& what) {
  m_fault = "byte " + std::to_string(m_offset) + ": " + what;
  return {};
}

std::optional<Block> BlockReader::Next() {
  m_fault.clear();
  if (m_offset == m_size) return {};
  const auto first = ReadAt(m_offset, sizeof(BlockHead));
  if (!first) return Fail("the file ends within a block");
  BlockHead head;
  std::memcpy(&head, first->data(), sizeof head);
  if (!IsKind(head.kind) || head.size > kMaxBlockBytes) return Fail("the head of a block is damaged");
  const auto packed = ReadAt(m_offset + sizeof head, head.packedSize);
  if (!packed) return Fail("the file ends within a block, or the block's head is damaged");
  if (FindChecksum(head, *packed) != head.checksum) {
    return Fail(std::string("a block is damaged (") + Name(static_cast<BlockKind>(head.kind)) + ", checksum)");
  }
  Block block{.kind = static_cast<BlockKind>(head.kind), .bytes = Bytes(head.size), .offset = m_offset};
  const std::size_t unpacked = ZSTD_decompress(block.bytes.data(), block.bytes.size(), packed->data(), packed->size());
  if (ZSTD_isError(unpacked) != 0 || unpacked != head.size) return Fail("a block cannot be unpacked");
  m_offset += sizeof head + head.packedSize;
  return block;
}

std::optional<BlockKind> BlockReader::Skip() {
  const auto bytes = ReadAt(m_offset, sizeof(BlockHead));
  if (!bytes) return {};
  BlockHead head;
  std::memcpy(&head, bytes->data(), sizeof head);
  const std::uint64_t after = m_offset + sizeof head + head.packedSize;
  if (!IsKind(head.kind) || after > m_size) return {};
  m_offset = after;
  return static_cast<BlockKind>(head.kind);
}

}  // namespace wobble::recording
