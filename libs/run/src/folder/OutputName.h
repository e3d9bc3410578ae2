// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace dyslam
{
/** A file, or a folder of numbered files, that an output writes to the run's folder. */
struct OutputName
{
  OutputName(const char* file) : name(file) {}
  OutputName(const char* folder, const char* extension_in) : name(folder), extension(extension_in)
  {
  }

  std::string name;
  std::string extension;  //!< for a folder: extension of its files (000000.label, ...)
};
}  // namespace dyslam
