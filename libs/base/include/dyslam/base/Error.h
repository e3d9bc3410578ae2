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

/** Calls `read()`, which reads the file or folder of a setting: errors that begin with its path
 * name the setting, too: "boxes.file: a.txt:3: ...". \param setting `section.key` \throws
 * UserError. */
template <typename Read>
auto namingSetting(const std::string& setting, const std::string& path, const Read& read)
{
  try
  {
    return read();
  }
  catch (const UserError& error)
  {
    const std::string message = error.what();
    throw UserError((message.rfind(path, 0) == 0 ? setting + ": " : "") + message);
  }
}
}  // namespace dyslam
