// The balls of tools. Requires `args` with setting and tools.
#ifndef PALPATE_LIB_MATTER_TOOLS_GLSL
#define PALPATE_LIB_MATTER_TOOLS_GLSL

ToolSpring toolSpring() {
  return ToolSpring(args.setting.now.spring.mass, args.setting.now.spring.stiffness, args.setting.now.spring.damping,
                    args.setting.now.spring.step);
}

// Applies the impulses of the matter to a tool.
void reactTool(uint t, vec3 impulse, vec3 angular) {
  const ToolSpring spring = toolSpring();
  const vec3 change = impulse / spring.mass;
  args.tools.at[t].velocity += change;
  args.tools.at[t].lag += spring.step * change;
  args.tools.at[t].impulse += impulse;
  args.tools.at[t].angular += angular;
}

#endif
