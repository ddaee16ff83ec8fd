// base.h, and the messages.
#include "cmake/pch/base.h"
#include "wire_generated.h"
