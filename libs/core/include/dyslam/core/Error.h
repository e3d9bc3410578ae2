// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace dyslam
{
/** Error that the user can fix: a bad file, field, key or value.
 *
 * The message is one line that names the file, the field and the fix. Programs print it and exit
 * with 1. Broken contracts between our own functions are std::logic_error instead.
 */
class UserError : public std::runtime_error
{
 public:
  using std::runtime_error::runtime_error;
};

/** Candidate with the smallest edit distance to `word`; empty if none is similar enough. */
template <typename Container>
[[nodiscard]] std::string nearestWord(const std::string& word, const Container& candidates);

/** Levenshtein distance between two words. */
[[nodiscard]] std::size_t editDistance(const std::string& a, const std::string& b);

template <typename Container>
std::string nearestWord(const std::string& word, const Container& candidates)
{
  std::string best;
  std::size_t best_distance = word.size() / 2 + 2;
  for (const auto& candidate : candidates)
  {
    const std::size_t distance = editDistance(word, candidate);
    if (distance < best_distance)
    {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}
}  // namespace dyslam
