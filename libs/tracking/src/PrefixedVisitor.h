// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Describes an options struct within another one: prepends a prefix to every key. */
class PrefixedVisitor : public OptionsVisitor
{
 public:
  PrefixedVisitor(OptionsVisitor& visitor, std::string prefix)
      : visitor_(visitor), prefix_(std::move(prefix))
  {
  }
  void real(const char* key, double& value, double min, double max, const char* help) override
  {
    visitor_.real((prefix_ + key).c_str(), value, min, max, help);
  }
  void integer(const char* key, int& value, int min, int max, const char* help) override
  {
    visitor_.integer((prefix_ + key).c_str(), value, min, max, help);
  }
  void flag(const char* key, bool& value, const char* help) override
  {
    visitor_.flag((prefix_ + key).c_str(), value, help);
  }
  void text(const char* key, std::string& value, const char* help) override
  {
    visitor_.text((prefix_ + key).c_str(), value, help);
  }
  void word(const char* key,
            std::string& value,
            const std::vector<std::string>& words,
            const char* help) override
  {
    visitor_.word((prefix_ + key).c_str(), value, words, help);
  }

 private:
  OptionsVisitor& visitor_;
  std::string prefix_;
};
}  // namespace dyslam
