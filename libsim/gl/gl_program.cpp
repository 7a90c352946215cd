#include "libsim/gl/gl_program.hpp"

#include <epoxy/gl.h>

#include <utility>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace sim {

namespace {

constexpr std::size_t max_shader_bytes = std::size_t{1} << 20;

std::string expand(const std::string& file, int depth) {
  if (depth > 8)
    throw base::Error("shaders/" + file, "includes itself, or is included more than 8 files deep",
                      "restore the shaders as they were installed");
  const std::string text = base::read_file(base::resource("shaders/" + file), max_shader_bytes);
  std::string expanded = "#line 1\n";
  std::size_t start = 0;
  for (int line = 1; start < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::string content = text.substr(start, end - start);
    const std::string key = "#include \"";
    if (content.starts_with(key)) {
      const std::string name = content.substr(key.size(), content.find('"', key.size()) - key.size());
      expanded += expand(name, depth + 1) + "#line " + std::to_string(line + 1) + "\n";
    } else {
      expanded += content + "\n";
    }
    start = end + 1;
  }
  return expanded;
}

std::string log_of(GLuint name, bool is_program) {
  std::string log(4096, '\0');
  GLsizei length = 0;
  if (is_program) {
    glGetProgramInfoLog(name, static_cast<GLsizei>(log.size()), &length, log.data());
  } else {
    glGetShaderInfoLog(name, static_cast<GLsizei>(log.size()), &length, log.data());
  }
  log.resize(static_cast<std::size_t>(length));
  return log;
}

GLuint compile(const ShaderFile& file, const std::string& defines) {
  const std::string text = "#version 450 core\n" + defines + expand(file.file, 0);
  const char* source = text.c_str();
  const GLuint shader = glCreateShader(file.type);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (!compiled) {
    const std::string log = log_of(shader, false);
    glDeleteShader(shader);
    throw base::Error("shaders/" + file.file, "does not compile: " + log,
                      "restore the shader as it was installed");
  }
  return shader;
}

}  // namespace

GlProgram::GlProgram(std::initializer_list<ShaderFile> files, const std::string& defines)
    : name_(glCreateProgram()) {
  for (const ShaderFile& file : files) {
    GLuint shader = 0;
    try {
      shader = compile(file, defines);
    } catch (...) {
      glDeleteProgram(name_);
      throw;
    }
    glAttachShader(name_, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(name_);
  GLint linked = GL_FALSE;
  glGetProgramiv(name_, GL_LINK_STATUS, &linked);
  if (!linked) {
    const std::string log = log_of(name_, true);
    glDeleteProgram(name_);
    throw base::Error("shaders/" + files.begin()->file, "does not link: " + log, "update the OpenGL driver");
  }
}

GlProgram::GlProgram(GlProgram&& other) noexcept
    : name_(std::exchange(other.name_, 0)), uniforms_(std::move(other.uniforms_)) {}

GlProgram& GlProgram::operator=(GlProgram&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(uniforms_, other.uniforms_);
  return *this;
}

GlProgram::~GlProgram() {
  if (name_) glDeleteProgram(name_);
}

void GlProgram::use() const { glUseProgram(name_); }

int GlProgram::uniform(const char* name) const {
  for (const auto& [known, location] : uniforms_) {
    if (known == name) return location;
  }
  return uniforms_.emplace_back(name, glGetUniformLocation(name_, name)).second;
}

}  // namespace sim
