#include "client/freeze/budget.h"

#include <algorithm>
#include <tuple>

namespace mirage {

Kept within_budget(const FrozenPart& part, std::uint64_t most_bytes) {
  using File = std::pair<std::string, FrozenEntry>;
  std::vector<File> wanted(part.files.begin(), part.files.end());
  std::stable_sort(wanted.begin(), wanted.end(), [](const File& a, const File& b) {
    const auto rank = [](const FrozenEntry& e) {
      return std::tuple(e.is_tile, e.spare, e.is_tile ? 0 : e.bytes(), -e.gain);
    };
    return rank(a.second) < rank(b.second);
  });
  Kept out;
  for (File& file : wanted) {
    if (out.bytes + file.second.bytes() > most_bytes) {
      out.left_out.push_back(file.first);
      continue;
    }
    out.bytes += file.second.bytes();
    out.files.push_back(std::move(file));
  }
  std::sort(out.files.begin(), out.files.end(),
            [](const File& a, const File& b) { return a.first < b.first; });
  return out;
}

}  // namespace mirage
