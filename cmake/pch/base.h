// What nearly every file includes, read once: a convenience of the build alone. Every file still
// includes what it uses; the linter's build, with -DMIRAGE_PCH=OFF, sees to it for what is shipped.
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
