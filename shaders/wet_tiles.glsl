// One word per tile of 16 x 8 px. Bit 0: the tile holds water; bit 1: the tile held water in the last picture. The
// passes skip a tile with neither bit, because its buffers hold no water from earlier pictures.
layout(std430, binding = 5) readonly buffer Wet { uint wet[]; };
bool is_dry() { return wet[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] == 0u; }
