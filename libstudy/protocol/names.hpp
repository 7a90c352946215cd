#pragma once
/// Names of a protocol that have a meaning elsewhere: of methods in libsim, of questions in the analyses.

#include <string>
#include <vector>

namespace study {

/// The methods that libsim computes. libstudy does not include it: a test of the programs holds both lists
/// equal.
const std::vector<std::string>& method_names();

/// Ids of questions that a program or a shipped analysis looks for: realism and the four items of
/// cybersickness (H1 to H3), gaze_kept and data_shared.
const std::vector<std::string>& known_question_ids();

}  // namespace study
