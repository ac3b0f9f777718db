// Where the tests find the source and what is built. Only places.cpp is compiled with these paths, so that what ccache
// has of all other files from one clone serves every other.
#pragma once

#include <string>

namespace wobble::test {

// Of a file or folder, from the source's root, such as "server/scenes".
std::string FindSource(const std::string& path);
// Of a program, or of what lies beside it, such as "wobbled" or "scripts/idle.lua".
std::string FindProgram(const std::string& name);
// The folder of trained bases that all tests' servers share.
std::string FindBases();
// The folder for pictures of scenes.
std::string FindCaptures();

}  // namespace wobble::test
