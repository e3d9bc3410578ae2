// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace dyslam
{
/** The name of a file as a YAML scalar: plain, or in double quotes where a plain one would mean
 * something else (YAML 1.2, sections 5.7 and 7.3.3; `#1.png`, `a: b.png`). */
[[nodiscard]] std::string yamlText(const std::string& name);

/** Inverse of yamlText(), for the scalar at the start of `text`.
 * \param end text after a plain scalar, such as ": "; empty: the scalar ends with the text */
[[nodiscard]] std::string fromYamlText(const std::string& text, const std::string& end = "");
}  // namespace dyslam
