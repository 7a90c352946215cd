// The caustics' light on a floor cell is summed in whole units, so that the sum does not depend on the order of the
// additions.
const float caustic_units = 65536.0;  // units in a cell as bright as without water
