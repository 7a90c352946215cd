// Bit 0: the work group's tile holds water; bit 1: it did in the last picture. A tile with neither keeps what the
// last picture left there, which says that there is none.
layout(std430, binding = 5) readonly buffer Wet { uint wet[]; };
bool is_dry() { return wet[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] == 0u; }
