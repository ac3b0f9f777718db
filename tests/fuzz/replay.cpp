// Runs a fuzz target over every file of a corpus folder, in any build and with any compiler: `..._replay FOLDER`.
//
// An input that once failed stays in the corpus. Each file is tried as it is, cut at every length, and with each single
// bit flipped. An empty or absent folder is an error.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "tests/fuzz/fuzz_target.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

void Try(const Bytes& bytes) { LLVMFuzzerTestOneInput(bytes.data(), bytes.size()); }

void TryWithDamage(Bytes bytes) {
  Try(bytes);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    Try(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)));
  }
  for (std::uint8_t& byte : bytes) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      byte = static_cast<std::uint8_t>(byte ^ 1U << bit);
      Try(bytes);
      byte = static_cast<std::uint8_t>(byte ^ 1U << bit);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s CORPUS_FOLDER\n", argv[0]);
    return 2;
  }
  int files = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1], error)) {
    std::ifstream file(entry.path(), std::ios::binary);
    TryWithDamage({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
    ++files;
  }
  std::printf("%d files of %s replayed\n", files, argv[1]);
  return files > 0 ? 0 : 1;
}
