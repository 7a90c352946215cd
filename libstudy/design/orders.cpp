#include "libstudy/design/orders.hpp"

#include <algorithm>
#include <numeric>

namespace study {

std::vector<int> latin_row(int k, int row) {
  std::vector<int> out(static_cast<std::size_t>(k));
  for (int i = 0; i < k; ++i) out[static_cast<std::size_t>(i)] = (i + row) % k;
  return out;
}

int williams_rows(int k) { return k % 2 == 0 || k == 1 ? k : 2 * k; }

std::vector<int> williams_row(int k, int row) {
  // Row 0 is 0, 1, k - 1, 2, k - 2, ...; row r adds r to each item, modulo k. If k is even, the differences
  // between neighbours are distinct modulo k. If k is odd, half of the differences occur twice, the others
  // never. So rows k to 2 k - 1 are rows 0 to k - 1 reversed: their neighbours have the other differences.
  std::vector<int> out;
  for (int i = 0; i < k; ++i) {
    const int zigzag = i % 2 == 1 ? (i + 1) / 2 : (k - i / 2) % k;
    out.push_back((zigzag + row) % k);
  }
  if (row >= k) std::reverse(out.begin(), out.end());
  return out;
}

std::vector<int> order_without_clashes(int k, const std::function<bool(int, int)>& clash,
                                       RandomStream& random) {
  const int most_starts = std::clamp(200'000'000 / std::max(k * k, 1), 10, 10'000);
  for (int start = 0; start < most_starts; ++start) {
    std::vector<int> left(static_cast<std::size_t>(k));
    std::iota(left.begin(), left.end(), 0);
    std::vector<int> out;
    while (!left.empty()) {
      std::vector<std::size_t> fits;
      for (std::size_t i = 0; i < left.size(); ++i) {
        if (out.empty() || !clash(out.back(), left[i])) fits.push_back(i);
      }
      if (fits.empty()) break;
      const auto chosen = fits[random.below(fits.size())];
      out.push_back(left[chosen]);
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(chosen));
    }
    if (left.empty()) return out;
  }
  return {};
}

}  // namespace study
