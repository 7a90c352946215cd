#pragma once
/// Shader programs from the project's shaders/ folder.

#include <initializer_list>
#include <string>

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
  int uniform(const char* name) const;  ///< location; -1 when the program has no use for it

 private:
  unsigned name_ = 0;
};

}  // namespace sim
