#include "formats/output_file.h"

#include "base/error.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <unistd.h>

namespace faceta {

namespace fs = std::filesystem;

void OutputFile::fail(const char* what) const {
  throw Error(std::string(what) + ": " + std::strerror(errno),
              {target_ == "-" ? "<stdout>" : target_});
}

OutputFile::OutputFile(const std::string& target) : target_(target) {
  static std::atomic<unsigned> counter{0};
  if (target == "-") {
    descriptor_ = STDOUT_FILENO;
    return;
  }
  std::error_code code;
  fs::file_status status = fs::status(target, code);
  if (fs::is_directory(status))
    throw Error("cannot write: this is a folder", {target});
  std::string name = target;
  int flags = O_WRONLY | O_CLOEXEC;
  if (!fs::exists(status) || fs::is_regular_file(status)) {
    name += "." + std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".tmp";
    flags |= O_CREAT | O_EXCL;
  }
  descriptor_ = ::open(name.c_str(), flags, 0666);
  if (descriptor_ < 0)
    fail("cannot write");
  if (name != target)
    temporary_ = name;
}

OutputFile::~OutputFile() {
  if (descriptor_ > STDERR_FILENO)
    ::close(descriptor_);
  if (!temporary_.empty())
    ::unlink(temporary_.c_str());
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR)
      continue;
    if (written < 0)
      fail("cannot write");
    bytes.remove_prefix(static_cast<size_t>(written));
  }
}

void OutputFile::commit() {
  if (target_ == "-")
    return;
  // The result of close counts: a full network disk says so only here.
  int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0)
    fail("cannot write");
  if (temporary_.empty())
    return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0)
    fail("cannot rename into place");
  temporary_.clear();
}

} // namespace faceta
