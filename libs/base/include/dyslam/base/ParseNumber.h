// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

namespace dyslam
{
/** The number in a word, in the C locale; a leading + is accepted. Numbers too small for the type
 * are 0, too large ones are infinite. \tparam Real float or double \return nothing if the word is
 * no number. */
template <typename Real>
[[nodiscard]] std::optional<Real> parseNumber(std::string_view word);
}  // namespace dyslam
