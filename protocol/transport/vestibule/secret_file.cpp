#include "protocol/transport/vestibule/secret_file.h"

#include <array>
#include <fstream>

#include "protocol/transport/vestibule/handshake.h"

namespace wobble::transport::vestibule {

std::optional<std::string> ReadSecret(const std::filesystem::path& file, std::string& error) {
  std::ifstream in(file, std::ios::binary);
  // One byte more than is allowed, and the end of the line: a file without an end is not read to it.
  std::array<char, kMaxCredentialBytes + 2> bytes{};
  in.read(bytes.data(), bytes.size());
  if (in.bad() || (in.gcount() == 0 && !in.eof())) {
    error = file.string() + ": cannot be read";
    return {};
  }
  std::string line(bytes.data(), static_cast<std::size_t>(in.gcount()));
  line = line.substr(0, line.find_first_of("\r\n"));
  if (!line.empty() && line.size() <= kMaxCredentialBytes) return line;
  error = file.string() + ": the first line must have 1 to " + std::to_string(kMaxCredentialBytes) + " bytes";
  return {};
}

}  // namespace wobble::transport::vestibule
