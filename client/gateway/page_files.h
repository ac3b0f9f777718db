// The page's files, all of them in memory: what a request asks for is looked up by name and never becomes a path.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace wobble::web {

struct PageFile {
  std::string_view type;   // as Content-Type has it
  bool isForever = false;  // its name changes with its content, so a browser may keep it
  std::string bytes;
  std::string gzip;  // the same compressed; empty where that saves nothing
};

// By the path of a request, "/index.html" or "/assets/main-1a2b3c4d.js".
using Page = std::map<std::string, PageFile, std::less<>>;

// All regular files below the folder but hidden ones, at most kMaxPageBytes of them. nullopt with one line in `error`
// when there is no index.html in it, a file cannot be read, or they are too many bytes.
[[nodiscard]] std::optional<Page> LoadPage(const std::filesystem::path& folder, std::string& error);
inline constexpr std::size_t kMaxPageBytes = 64 * 1024 * 1024;

// What a request's target, such as "/" or "/index.html?x", names; null when there is no such file.
[[nodiscard]] const PageFile* FindFile(const Page& page, std::string_view target);

// Whether an Accept-Encoding header allows gzip.
[[nodiscard]] bool AcceptsGzip(std::string_view acceptEncoding);

}  // namespace wobble::web
