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
}  // namespace dyslam
