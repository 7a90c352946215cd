#pragma once
/// Shader programs from the project's shaders/ folder.

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace sim {

struct ShaderFile {
  unsigned type;     ///< GL_COMPUTE_SHADER, ...
  std::string file;  ///< below shaders/
};

/// A linked program; moved, never copied. Needs a current context.
class GlProgram {
 public:
  GlProgram() = default;
  /// `defines` is put behind #version 450 core; a line `#include "name"` brings in another file of shaders/.
  /// Errors (base::Error) name the file and carry the driver's log.
  GlProgram(std::initializer_list<ShaderFile> files, const std::string& defines = "");
  GlProgram(GlProgram&& other) noexcept;
  GlProgram& operator=(GlProgram&& other) noexcept;
  ~GlProgram();

  void use() const;
  unsigned name() const { return name_; }
  /// Location; -1 when the program has no use for it. The driver is asked once.
  int uniform(const char* name) const;

 private:
  unsigned name_ = 0;
  mutable std::vector<std::pair<std::string, int>> uniforms_;
};

}  // namespace sim
