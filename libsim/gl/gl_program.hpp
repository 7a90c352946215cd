#pragma once
/// Shader programs from the project's shaders/ folder.

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace sim {

struct ShaderFile {
  unsigned type;     ///< GL_COMPUTE_SHADER, ...
  std::string file;  ///< relative to shaders/
};

/// A linked shader program; movable, not copyable. Needs a current context.
class GlProgram {
 public:
  GlProgram() = default;
  /// `defines` is inserted after #version 450 core; a line `#include "name"` includes another file of
  /// shaders/. base::Error names the file; errors of compiling and linking contain the driver's log.
  GlProgram(std::initializer_list<ShaderFile> files, const std::string& defines = "");
  GlProgram(GlProgram&& other) noexcept;
  GlProgram& operator=(GlProgram&& other) noexcept;
  ~GlProgram();

  void use() const;
  unsigned name() const { return name_; }
  /// Location of a uniform; -1 if the program does not use it. The driver is queried once per name.
  int uniform(const char* name) const;

 private:
  unsigned name_ = 0;
  mutable std::vector<std::pair<std::string, int>> uniforms_;
};

}  // namespace sim
