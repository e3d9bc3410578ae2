// SPDX-License-Identifier: BSD-3-Clause
#include "BagTopics.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>
#include <dyslam/io/OptionError.h>

#include <algorithm>

namespace dyslam
{
std::string namesOf(const Bag& bag, const std::function<bool(const BagTopic&)>& wanted)
{
  std::string names;
  for (const BagTopic& topic : bag.topics())
  {
    if (wanted(topic))
    {
      appendWord(names, topic.name);
    }
  }
  return names;
}

std::size_t topicNamed(const std::string& input,
                       const Bag& bag,
                       const std::string& option,
                       const std::string& name,
                       const std::function<bool(const BagTopic&)>& wanted)
{
  const auto& topics = bag.topics();
  for (std::size_t i = 0; i < topics.size(); ++i)
  {
    if (topics[i].name == name && wanted(topics[i]))
    {
      return i;
    }
  }
  const auto found = std::find_if(topics.begin(), topics.end(),
                                  [&name](const BagTopic& topic) { return topic.name == name; });
  const std::string usable = namesOf(bag, wanted);
  const std::string what =
      input + ": " + option + " " + name +
      (found == topics.end() ? " is not in it" : ": " + found->type + " is not read");
  if (usable.empty())
  {
    throw OptionError(what + "; --list shows the topics", "--list");
  }
  throw UserError(what + "; use " + usable);
}
}  // namespace dyslam
