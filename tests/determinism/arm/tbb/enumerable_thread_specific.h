#include "blocked_range.h"
