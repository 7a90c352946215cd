#pragma once
/// Names in protocols that other parts rely on: methods and surfaces (libsim), and questions (analyses).

#include <string>
#include <vector>

namespace study {

/// Names of the methods that libsim implements. libstudy/protocol does not include libsim, so a test compares
/// this list with libsim's.
const std::vector<std::string>& method_names();

/// Words for the ways in which libsim draws particles: "ellipsoids" and "spheres". The test of method_names()
/// compares this list too.
const std::vector<std::string>& surface_names();

/// Ids of questions that a program or a shipped analysis looks for: realism and the four items of
/// cybersickness, gaze_kept and data_shared.
const std::vector<std::string>& known_question_ids();

}  // namespace study
