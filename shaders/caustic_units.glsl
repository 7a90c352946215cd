// The caustics' light on a cell of the floor is a whole number, so that its sum does not depend on who came first.
const float caustic_units = 65536.0;  // as bright as without water
