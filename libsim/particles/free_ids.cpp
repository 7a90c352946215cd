#include "libsim/particles/free_ids.hpp"

namespace sim::SIM_BACKEND {

namespace {

struct MarkFree {
  int* free;
  SIM_FN void operator()(int id) const { free[id] = 1; }
};

struct MarkTaken {
  const int* id;
  const std::uint8_t* gone;
  int* free;
  int capacity;
  SIM_FN void operator()(int i) const {
    if (gone && gone[i]) return;
    if (id[i] >= 0 && id[i] < capacity) free[id[i]] = 0;
  }
};

struct ListFree {
  const int* free;
  const int* sums;
  int* ids;
  SIM_FN void operator()(int id) const {
    if (free[id]) ids[sums[id] - 1] = id;
  }
};

}  // namespace

void list_free_ids(Reads<Column::Id> p, const std::uint8_t* gone, Scanner& scanner, Array<int>& flags,
                   Array<int>& sums, Array<int>& ids) {
  const int capacity = p.capacity();
  const auto size = static_cast<std::size_t>(capacity);
  flags.resize(size);
  ids.resize(size);
  for_each("mark free ids", capacity, MarkFree{flags.data()});
  for_each("mark taken ids", p.size(), MarkTaken{p.id(), gone, flags.data(), capacity});
  scanner.inclusive_sum(flags, sums);
  for_each("list free ids", capacity, ListFree{flags.data(), sums.data(), ids.data()});
}

}  // namespace sim::SIM_BACKEND
