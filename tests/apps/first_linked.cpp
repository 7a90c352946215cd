/// Code of strings and JSON, compiled at -O2. Each file that uses a template holds a copy of its code, and
/// the linker keeps the first copy for the whole program. This file is linked first: otherwise the libraries
/// would run the copies of the tests, which are compiled at -O0.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

template class std::basic_string<char>;
template class std::vector<std::string>;
template class nlohmann::basic_json<>;
template class nlohmann::basic_json<nlohmann::ordered_map>;
template class std::vector<nlohmann::json>;
template class std::vector<nlohmann::ordered_json>;
