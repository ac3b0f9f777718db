#include "tests/support/places.h"

namespace wobble::test {

std::string FindSource(const std::string& path) { return WOBBLE_SOURCE_DIR "/" + path; }
std::string FindProgram(const std::string& name) { return WOBBLE_BIN_DIR "/" + name; }
std::string FindBases() { return WOBBLE_CACHE_DIR; }
std::string FindCaptures() { return WOBBLE_CAPTURES_DIR; }

}  // namespace wobble::test
