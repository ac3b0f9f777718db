// Tells people at a terminal where their friends find the page.
#pragma once

#include <cstdint>
#include <string>

namespace wobble::command {

// TCP port of the page, unless another one is asked for.
inline constexpr std::uint16_t kPagePort = 8080;

// Prints the address of a page, that of this machine which friends in the same network most likely reach, and its QR
// code, to standard output. For people alone: prints nothing where that is no terminal, or where only this machine
// reaches the page; no code where the terminal is too narrow. bind: address that the page is served at, numeric.
void ShowPageToFriends(const std::string& scheme, const std::string& bind, unsigned port);

}  // namespace wobble::command
