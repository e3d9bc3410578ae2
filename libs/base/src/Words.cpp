// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Words.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace dyslam
{
std::string trimmed(std::string_view text, std::string_view blanks)
{
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos)
  {
    return {};
  }
  return std::string(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

std::size_t editDistance(const std::string& a, const std::string& b)
{
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i)
  {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j)
    {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}
}  // namespace dyslam
