#pragma once
// A cluster to which things happen, one after the other, in an order that a seed decides.
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tests/system/cluster/calm.h"
#include "tests/system/cluster/hand_worker.h"

namespace penumbra {

class Drill {
 public:
  explicit Drill(uint64_t seed);

  /// Injects faults for so long, while jobs come and are checked.
  void run(double seconds);
  /// Lets the cluster come to rest; every job that was not cancelled has calm()'s picture. Then audits.
  void settle();

  int faults() const;
  std::string summary() const;

 private:
  struct Job {
    JobId id;
    bool cancelled = false, checked = false;
  };
  struct Absent {
    int worker;
    double until;  ///< steady seconds; then it goes on
  };
  /// A lease whose worker, a rogue of this name, has said nothing since.
  struct Kept {
    DesiredLease lease;
    std::string rogue;
    double since;
  };

  uint64_t draw(uint64_t below) { return std::uniform_int_distribution<uint64_t>(0, below - 1)(random_); }
  double draw_seconds(double most) { return std::uniform_real_distribution<double>(0, most)(random_); }

  void inject();
  void restart_server();
  void start_worker(int slot);
  void kill_worker(int slot);
  void stop_worker();
  void resume_absent(bool all);
  void stop_server();
  void damage_result();
  void damage_cache();
  void jump_clock();
  void renew_kept(const std::string& rogue);
  void rogue_vanishes();
  void rogue_sends_garbage();
  void rogue_repeats();
  void rogue_comes_late();
  void drain_worker();
  void cancel_job();
  void kill_everything();
  void hang_up();

  void tend_jobs();
  void check_leases();
  bool check_picture(Job& job, double seconds);

  Cluster cluster_;
  std::mt19937_64 random_;
  Digest bundle_;
  std::map<std::string, int> injected_;
  std::vector<Job> jobs_;
  std::vector<std::unique_ptr<Process>> workers_;
  std::vector<Absent> absent_;
  int rogues_ = 0;
  std::vector<WorkerState> said_;
  std::vector<Kept> kept_;
};

}  // namespace penumbra
