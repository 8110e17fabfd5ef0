// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace noli::cli {

/// The candidate nearest to `word` by edit distance, if near enough to be what was meant;
/// else "".
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace noli::cli
