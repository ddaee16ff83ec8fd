#pragma once
// The figures of `mirage-view --stats`, explained: the page that --help-statistics prints.

#include <string>

namespace mirage {

/// Every figure of the statistics and of the real-time file beside them, as a Markdown page.
/// `tests/e2e/reference_test.cpp` compares it with what a run writes.
std::string statistics_page();

}  // namespace mirage
