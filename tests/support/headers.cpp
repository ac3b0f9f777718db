// A precompiled header needs a source to belong to.
#include "tests/support/headers.h"
