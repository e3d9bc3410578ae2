// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Error.h>

#include <string>
#include <utility>

namespace dyslam
{
/** An error of a conversion whose message advises an option of the converter's program. Programs
 * that convert by themselves may not have it. */
class OptionError : public UserError
{
 public:
  /** \param flag the first one of the message: "--list" */
  OptionError(const std::string& message, std::string flag)
      : UserError(message), flag_(std::move(flag))
  {
  }

  [[nodiscard]] const std::string& flag() const { return flag_; }

 private:
  std::string flag_;
};
}  // namespace dyslam
