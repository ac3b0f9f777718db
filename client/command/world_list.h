// Lists of worlds elsewhere: a file in JSON that anybody can write and any web server can serve.
//
//   {"version": 1, "worlds": [
//     {"name": "Ada's", "page": "https://play.example.org/", "address": "play.example.org:7777", "scene": "arena"}]}
//
// `name` and one of `page` (for browsers) and `address` (for programs) are required. Other fields are ignored,
// so that later versions may have more.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wobble::command {

struct ListedWorld {
  std::string name;     // as text from the wire is shown: one clean line
  std::string page;     // http:// or https://; empty: none
  std::string address;  // HOST:PORT; empty: none
  std::string scene;    // empty: not said
};

inline constexpr std::size_t kMaxListBytes = 256 * 1024;
inline constexpr std::size_t kMaxListedWorlds = 100;
inline constexpr std::size_t kMaxListedNameBytes = 64;  // of a name or scene
inline constexpr std::size_t kMaxPageUrlBytes = 200;

// nullopt with a line in `error` that names all mistakes, or the first few.
[[nodiscard]] std::optional<std::vector<ListedWorld>> ParseWorldList(std::string_view json, std::string& error);
// The same of a file, which must be a regular one.
[[nodiscard]] std::optional<std::vector<ListedWorld>> LoadWorldList(const std::string& path, std::string& error);

// As ParseWorldList reads it.
[[nodiscard]] std::string FormatWorldList(const std::vector<ListedWorld>& worlds);
// The array alone, for the worlds with a page: with their names, pages and scenes.
[[nodiscard]] std::string FormatPages(const std::vector<ListedWorld>& worlds);

}  // namespace wobble::command
