// SPDX-License-Identifier: BSD-3-Clause
// Lists of words, and words that are in none, for messages.
#pragma once

#include <cstddef>
#include <iterator>
#include <string>
#include <string_view>

namespace dyslam
{
/** Appends a word, or a sentence, to a list of them: "a, b". */
inline void appendWord(std::string& list, std::string_view word, std::string_view separator = ", ")
{
  if (!list.empty())
  {
    list += separator;
  }
  list += word;
}

/** The words as a list: "a, b". */
template <typename Container>
[[nodiscard]] std::string joined(const Container& words, std::string_view separator = ", ")
{
  std::string list;
  for (const auto& word : words)
  {
    appendWord(list, word, separator);
  }
  return list;
}

/** The text without these characters at its begin and end. */
[[nodiscard]] std::string trimmed(std::string_view text, std::string_view blanks = " \t\r");

/** Levenshtein distance between two words. */
[[nodiscard]] std::size_t editDistance(const std::string& a, const std::string& b);

/** Of `candidates`, the one nearest to `word` by edit distance; empty when none is near. */
template <typename Container>
[[nodiscard]] std::string nearestWord(const std::string& word, const Container& candidates)
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

/** What may have been meant by a word that is none of the known ones, to follow a message: "; did
 * you mean 'cauchy'? (one of: none, cauchy)". The known ones are listed if they are few. */
template <typename Container>
[[nodiscard]] std::string meantWord(const std::string& word, const Container& known)
{
  constexpr std::size_t most_listed = 20;
  const std::string nearest = word.empty() ? "" : nearestWord(word, known);
  std::string advice;
  if (!nearest.empty())
  {
    advice += "; did you mean '" + nearest + "'?";
  }
  if (std::size(known) <= most_listed)
  {
    advice += " (one of: " + joined(known) + ")";
  }
  return advice;
}

/** Error message for a word of the user that is none of the known ones: "unknown kernel 'cauchi';
 * did you mean 'cauchy'? (one of: none, cauchy)". \param kind what the word should name */
template <typename Container>
[[nodiscard]] std::string unknownWord(const std::string& kind,
                                      const std::string& word,
                                      const Container& known)
{
  return "unknown " + kind + " '" + word + "'" + meantWord(word, known);
}
}  // namespace dyslam
