// Files are read and compressed once, at the start: a page is a megabyte, and no file is opened while people play. No
// request reaches the file system, so ".." leads nowhere. zlib compresses here rather than in the page's build, so that
// the build has a single output.
#include "client/gateway/page_files.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>
#include <utility>

namespace wobble::gateway {
namespace {

constexpr std::pair<std::string_view, std::string_view> kTypes[] = {
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".mjs", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".wasm", "application/wasm"},
    {".json", "application/json"},
    {".map", "application/json"},
    {".webmanifest", "application/manifest+json"},
    {".txt", "text/plain; charset=utf-8"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".jpg", "image/jpeg"},
    {".webp", "image/webp"},
    {".ico", "image/x-icon"},
    {".woff2", "font/woff2"},
};

std::string_view FindType(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  const auto* found =
      std::find_if(std::begin(kTypes), std::end(kTypes), [&](const auto& e) { return e.first == ending; });
  return found == std::end(kTypes) ? "application/octet-stream" : found->second;
}

// Whether the name is one that vite gives: "assets/main-1a2b3c4d.js", eight characters of the content's hash after a
// hyphen.
bool IsNamedByContent(const std::string& name) {
  constexpr std::size_t kHashCharacters = 8;
  if (name.rfind("/assets/", 0) != 0) return false;
  const std::string stem = std::filesystem::path(name).stem().string();
  if (stem.size() <= kHashCharacters || stem[stem.size() - kHashCharacters - 1] != '-') return false;
  return std::all_of(stem.end() - kHashCharacters, stem.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; });
}

// In gzip's format; empty when that is no smaller, as for a picture.
std::string Compress(const std::string& bytes) {
  constexpr int kGzip = MAX_WBITS + 16;  // zlib's way of asking for gzip's head and tail
  constexpr int kMemory = 9;
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  std::string compressed(bytes.size(), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(compressed.data());
  stream.avail_out = static_cast<uInt>(compressed.size());
  const bool isDone = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  compressed.resize(isDone ? stream.total_out : 0);
  deflateEnd(&stream);
  return compressed;
}

bool IsHidden(const std::string& name) { return name.find("/.") != std::string::npos; }

}  // namespace

std::optional<Page> LoadPage(const std::filesystem::path& folder, std::string& error) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(folder / "index.html", failure)) {
    error = "no page: '" + (folder / "index.html").string() + "' is not there";
    return std::nullopt;
  }
  Page page;
  std::size_t total = 0;
  for (std::filesystem::recursive_directory_iterator entry(folder, failure), end; !failure && entry != end;
       entry.increment(failure)) {
    const std::string name = "/" + entry->path().lexically_relative(folder).generic_string();
    if (IsHidden(name) || !entry->is_regular_file(failure)) continue;
    total += entry->file_size(failure);
    if (total > kMaxPageBytes) {
      error = "page '" + folder.string() + "': more than " + std::to_string(kMaxPageBytes >> 20) + " MiB of files";
      return std::nullopt;
    }
    std::ifstream stream(entry->path(), std::ios::binary);
    PageFile file{.type = FindType(entry->path()), .isForever = IsNamedByContent(name), .bytes = {}, .gzip = {}};
    file.bytes.assign(std::istreambuf_iterator<char>(stream), {});
    if (!stream.is_open() || stream.bad()) {
      error = "page: '" + entry->path().string() + "' cannot be read";
      return std::nullopt;
    }
    file.gzip = Compress(file.bytes);
    page.emplace(name, std::move(file));
  }
  if (!failure) return page;
  error = "page '" + folder.string() + "' cannot be read: " + failure.message();
  return std::nullopt;
}

const PageFile* FindFile(const Page& page, std::string_view target) {
  const std::string_view name = target.substr(0, target.find('?'));
  const auto found = page.find(name == "/" ? "/index.html" : name);
  return found == page.end() ? nullptr : &found->second;
}

bool AcceptsGzip(std::string_view acceptEncoding) {
  const std::size_t at = acceptEncoding.find("gzip");
  if (at == std::string_view::npos) return false;
  const std::string_view rest = acceptEncoding.substr(at, acceptEncoding.find(',', at) - at);
  const std::size_t quality = rest.find("q=0");  // "q=0" and "q=0.000" refuse it, "q=0.5" does not
  return quality == std::string_view::npos || rest.find_first_of("123456789", quality + 3) != std::string_view::npos;
}

}  // namespace wobble::gateway
