#include "tests/bench/scale/server_process.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

namespace penumbra {

ServerProcess::ServerProcess(const std::string& folder, const std::vector<std::string>& flags) {
  const std::string file = folder + "/address";
  std::vector<std::string> command = {PENUMBRA_SERVER,   "--listen",       "127.0.0.1:0", "--store",
                                      folder + "/store", "--address-file", file,          "--log-level",
                                      "warning"};
  command.insert(command.end(), flags.begin(), flags.end());
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  while (address_.empty() && waitpid(pid_, nullptr, WNOHANG) == 0) {
    std::ifstream(file) >> address_;
    if (address_.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

ServerProcess::~ServerProcess() {
  kill(pid_, SIGTERM);
  waitpid(pid_, nullptr, 0);
}

double ServerProcess::cpu_seconds() const {
  std::ifstream in("/proc/" + std::to_string(pid_) + "/stat");
  std::stringstream text;
  text << in.rdbuf();
  // After the name in parentheses: state is field 3, utime 14, stime 15, in clock ticks.
  std::istringstream fields(text.str().substr(text.str().rfind(')') + 2));
  std::string skipped;
  for (int field = 3; field < 14; ++field) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double ServerProcess::resident_bytes() const {
  std::ifstream in("/proc/" + std::to_string(pid_) + "/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("VmHWM:", 0) == 0) return 1024 * std::stod(line.substr(6));
  return 0;
}

}  // namespace penumbra
