/// Strings and JSON, compiled with more than the tests are (tests/CMakeLists.txt). Of a template's code the
/// linker takes the copy that comes first, also for the libraries that a test calls: it is this one.

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

template class std::basic_string<char>;
template class std::vector<std::string>;
template class nlohmann::basic_json<>;
template class nlohmann::basic_json<nlohmann::ordered_map>;
template class std::vector<nlohmann::json>;
template class std::vector<nlohmann::ordered_json>;
