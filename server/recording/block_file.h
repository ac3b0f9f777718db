// Files of blocks, each compressed and checked by itself: a file that was cut short is good up to its last whole block,
// and damage is found in the block where it is.
//
//   bytes 0..7    "wobrec" CR LF, so that a file that was carried as text is noticed
//   8..11         kFormatVersion
//   then blocks:  kind u8, three zeros, size u32 when unpacked, size u32 when packed, CRC-32 of these 12 bytes and of
//                 what follows u32, and the packed bytes (zstd)
//
// Numbers are little-endian. CRC-32 finds every error of up to 32 bits in a row.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "server/recording/archive.h"

namespace wobble::recording {

// Of all that is stored: the blocks, what is in them (fields.h), and the physics that plays them, which is to change it
// when golden hashes change. Files of another version are refused by name.
inline constexpr std::uint32_t kFormatVersion = 5;

// The most bytes of a block, unpacked: a file cannot ask for more memory.
inline constexpr std::size_t kMaxBlockBytes = std::size_t{128} << 20;

enum class BlockKind : std::uint8_t {
  kHead = 1,      // what is played: the scene and how it began
  kSecond = 2,    // what entered the world in a second, and how the world was then
  kKeyframe = 3,  // the whole state after a tick
  kEnd = 4,       // of a recording that was ended on purpose
  kCheckpoint = 5,
};
[[nodiscard]] const char* Name(BlockKind kind);

struct Block {
  BlockKind kind = BlockKind::kHead;
  Bytes bytes;
  std::uint64_t offset = 0;  // in the file
};

// The first bytes of a file, and one block.
[[nodiscard]] Bytes MakeFileHead();
[[nodiscard]] Bytes PackBlock(BlockKind kind, std::span<const std::uint8_t> bytes);

// What PackBlock made; nullopt for anything else.
[[nodiscard]] std::optional<Block> UnpackBlock(std::span<const std::uint8_t> packed);

// Writes a whole file that is its owner's alone, to the disk. Returns what is wrong; empty: nothing.
[[nodiscard]] std::string WriteWhole(const std::filesystem::path& path, const Bytes& bytes);

// Whether it is a file that begins as all of ours do, of any format version: a recording, an index or a state.
[[nodiscard]] bool IsBlockFile(const std::filesystem::path& path);

// Reads a file from its beginning to its last good block. Any file is safe.
class BlockReader {
 public:
  // Returns what is wrong in words that follow the file's name; empty: nothing.
  [[nodiscard]] std::string Open(const std::filesystem::path& path);
  // The next block; nullopt at the end, and where the file is damaged (Fault).
  [[nodiscard]] std::optional<Block> Next();
  // The kind of the next block, which is passed over unchecked but for its head; nullopt at the end, and where the file
  // ends within it.
  [[nodiscard]] std::optional<BlockKind> Skip();
  // Goes on at a block's offset.
  void Seek(std::uint64_t offset) { m_offset = offset; }
  [[nodiscard]] std::uint64_t Offset() const { return m_offset; }
  [[nodiscard]] bool IsAtEnd() const { return m_offset == m_size; }
  // Why Next returned nullopt: empty at the end, otherwise what is wrong and at which byte.
  [[nodiscard]] const std::string& Fault() const { return m_fault; }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  // nullopt where the file ends before.
  [[nodiscard]] std::optional<Bytes> ReadAt(std::uint64_t offset, std::size_t count);
  [[nodiscard]] std::optional<Block> Fail(const std::string& what);

  std::unique_ptr<std::FILE, Closer> m_file;
  std::uint64_t m_size = 0;
  std::uint64_t m_offset = 0;
  std::string m_fault;
};

}  // namespace wobble::recording
