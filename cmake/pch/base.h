// Headers that nearly every file includes, compiled once to make builds quicker. Every file still
// includes what it uses: the linter builds with -DMIRAGE_PCH=OFF.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>
