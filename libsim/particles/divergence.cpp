#include "libsim/particles/divergence.hpp"

#include <cstdio>

namespace sim {

const char* in_words(Trouble cause) {
  switch (cause) {
    case Trouble::NotFinite:
      return "is not finite";
    case Trouble::FarOutside:
      return "was far outside the tank";
    case Trouble::TooFast:
      return "was faster than the speed limit and was slowed";
    case Trouble::NeighboursDropped:
      return "has more neighbours than its list can store";
    case Trouble::Coincident:
      return "has the same position as another particle";
    case Trouble::TooDense:
      return "is denser than 1.5 rho_0";
  }
  return "";
}

std::string in_words(const Divergence& divergence) {
  std::string out =
      "frame " + std::to_string(divergence.frame) + ", particle " + std::to_string(divergence.particle);
  if (const auto& at = divergence.where_m) {
    char place[120];
    std::snprintf(place, sizeof place, " at (%.3f, %.3f, %.3f) m", (*at)[0], (*at)[1], (*at)[2]);
    out += place;
  }
  return out + " " + in_words(divergence.cause) + "; " + std::to_string(divergence.count) +
         (divergence.count == 1 ? " case" : " cases") + " so far";
}

}  // namespace sim
