// The page's files, held in memory: a request is looked up by name and never becomes a path.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace wobble::gateway {

struct PageFile {
  std::string_view type;   // for Content-Type
  bool isForever = false;  // the name changes with the content, so a browser may keep it
  std::string bytes;
  std::string gzip;  // the bytes compressed; empty where that saves nothing
};

// By the path of a request, such as "/index.html" or "/assets/main-1a2b3c4d.js".
using Page = std::map<std::string, PageFile, std::less<>>;

// Loads all regular files below the folder except hidden ones. nullopt with one line in `error` when there is no
// index.html, a file cannot be read, or they have more than kMaxPageBytes in all.
[[nodiscard]] std::optional<Page> LoadPage(const std::filesystem::path& folder, std::string& error);
inline constexpr std::size_t kMaxPageBytes = 64 * 1024 * 1024;

// The file that a request's target, such as "/" or "/index.html?x", names; null when there is none.
[[nodiscard]] const PageFile* FindFile(const Page& page, std::string_view target);

// Whether an Accept-Encoding header allows gzip.
[[nodiscard]] bool AcceptsGzip(std::string_view acceptEncoding);

}  // namespace wobble::gateway
