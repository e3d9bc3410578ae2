// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/ParseNumber.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>
#include <string>
#include <system_error>

namespace dyslam
{
template <typename Real>
std::optional<Real> parseNumber(std::string_view word)
{
  if (word.size() > 1 && word.front() == '+')
  {
    word.remove_prefix(1);
  }
  Real value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size())
  {
    return std::nullopt;
  }
  if (error == std::errc::result_out_of_range)
  {
    // from_chars() does not tell too small from too large, a stream does.
    std::istringstream stream{std::string(word)};
    stream.imbue(std::locale::classic());
    stream >> value;
    return std::abs(value) > 1 ? std::copysign(std::numeric_limits<Real>::infinity(), value)
                               : Real{0};
  }
  return value;
}
template std::optional<float> parseNumber<float>(std::string_view word);
template std::optional<double> parseNumber<double>(std::string_view word);
}  // namespace dyslam
