/// Code of strings and JSON, compiled at -O2. Each file that uses a template has a copy of its code, and the
/// linker uses the first copy for the whole program. This file is linked first: otherwise the libraries would
/// run the tests' copies, which are compiled at -O0.

#include <string>
#include <vector>

#include "stats/base/json.hpp"

template class std::basic_string<char>;
template class std::vector<std::string>;
template class std::vector<base::Json>;
