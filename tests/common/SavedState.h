// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/StateArchive.h>

#include <string>

namespace dyslam
{
/** The bytes of the state of `value`. */
template <typename T>
[[nodiscard]] std::string saved(T& value)
{
  StateArchive archive;
  archive(value);
  return archive.bytes();
}

/** A value with the state that saved() gave. \throws UserError if the bytes are too few or too
 * many. */
template <typename T>
[[nodiscard]] T loaded(const std::string& bytes)
{
  T value;
  StateArchive archive(bytes);
  archive(value);
  archive.requireEnd();
  return value;
}
}  // namespace dyslam
