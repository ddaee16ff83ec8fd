// wire.h, and what tests are written with.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "cmake/pch/wire.h"
