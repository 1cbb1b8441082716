#include "base/error.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "formats/measured_loader.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

namespace {

int run(int argc, char** argv) {
  faceta::load_measured_files();
  int code = faceta::cli::parse_arguments(argc, argv)();
  // A full disk behind a pipe or a redirection says so only here.
  if (std::fflush(stdout) != 0 || std::ferror(stdout))
    throw faceta::Error(std::string("cannot write: ") + std::strerror(errno), {"<stdout>"});
  return code;
}

} // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const faceta::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
  } catch (const std::bad_alloc&) {
    std::fputs("error: out of memory\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
  }
  return faceta::cli::kInputError;
}
