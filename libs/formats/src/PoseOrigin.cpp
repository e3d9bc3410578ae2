// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/PoseOrigin.h>

#include <algorithm>
#include <array>
#include <vector>

namespace dyslam
{
namespace
{
struct NamedSource
{
  const char* word;
  PoseSource source;
};
constexpr std::array<NamedSource, 4> pose_sources{{{"unknown", PoseSource::unknown},
                                                   {"simulated", PoseSource::simulated},
                                                   {"gnss_ins", PoseSource::gnss_ins},
                                                   {"given", PoseSource::given}}};
}  // namespace

std::string PoseOrigin::text() const
{
  const std::string from = name.empty() ? "" : " (" + name + ")";
  switch (source)
  {
    case PoseSource::simulated:
      return "simulated" + from + ", exact";
    case PoseSource::gnss_ins:
      return "GNSS/INS" + from + ", not exact";
    case PoseSource::given:
      return "given poses" + from + ", not known to be exact";
    case PoseSource::unknown:
      break;
  }
  return "of unknown source" + from + ", not known to be exact";
}

std::string PoseOrigin::differenceTo() const
{
  return source == PoseSource::gnss_ins ? "GNSS/INS" : "";
}

std::string toString(PoseSource source)
{
  return std::find_if(pose_sources.begin(), pose_sources.end(),
                      [source](const NamedSource& named) { return named.source == source; })
      ->word;
}

PoseSource poseSourceFromString(const std::string& word)
{
  const auto found = std::find_if(pose_sources.begin(), pose_sources.end(),
                                  [&word](const NamedSource& named) { return word == named.word; });
  return found == pose_sources.end() ? PoseSource::unknown : found->source;
}

void describePoseSource(OptionsVisitor& visitor,
                        const char* key,
                        PoseSource& source,
                        const char* help)
{
  std::vector<std::string> words;
  for (const NamedSource& named : pose_sources)
  {
    words.emplace_back(named.word);
  }
  std::string word = toString(source);
  visitor.word(key, word, words, help);
  source = poseSourceFromString(word);
}
}  // namespace dyslam
