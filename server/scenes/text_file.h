// Reads the files of a scene: whole, of bounded size, and never from what is no file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace wobble::scenes {

// Bytes of a scene and of a mesh. The largest shipped ones have 16 KiB and 21 KiB; a mesh of the most vertices that a
// body may have, written out in full, has 1 MiB.
inline constexpr std::size_t kMaxSceneBytes = std::size_t{1} << 20;
inline constexpr std::size_t kMaxMeshBytes = std::size_t{4} << 20;

// Reads a regular file of at most maxBytes, a multiple of 1 MiB, into `text`. Returns what is wrong, in words that
// follow the file's name, such as "is a directory, not a regular file of at most 1 MiB"; empty: nothing. A FIFO and a
// device are refused without being opened: to open the one waits for a writer, and the other may never end.
[[nodiscard]] std::string ReadTextFile(const std::filesystem::path& path, std::size_t maxBytes, std::string& text);

}  // namespace wobble::scenes
