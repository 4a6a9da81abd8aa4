#include <cstdio>
#include <filesystem>
#include <memory>

#include "client/against.h"
#include "client/commands.h"
#include "client/exit_code.h"
#include "client/gate_run.h"
#include "client/parse_text.h"
#include "client/run_json.h"
#include "film/atomic_file.h"
#include "proto/status.h"

namespace penumbra {
namespace {

constexpr int64_t kMostRounds = 1000;

struct GateCommand {
  std::string baseline, write_baseline, tolerance = "5%", cpu_tolerance, noise, rounds;
  AgainstOptions against;  ///< job.scene is the positional: a run.json or a scene
  bool json = false;
};

absl::StatusOr<GateOptions> gate_options(const GateCommand& c) {
  GateOptions options;
  ASSIGN_OR_RETURN(options.tolerance, parse_percent("--tolerance", c.tolerance));
  options.cpu_tolerance = options.tolerance;
  if (!c.cpu_tolerance.empty()) {
    ASSIGN_OR_RETURN(options.cpu_tolerance, parse_percent("--cpu-tolerance", c.cpu_tolerance));
  }
  if (!c.noise.empty()) {
    ASSIGN_OR_RETURN(const Json noise, read_json(c.noise));
    ASSIGN_OR_RETURN(options.noise, noise_from_json(noise));
  }
  return options;
}

/// Whatever was typed that would be ignored is refused. Without --against nothing is rendered.
absl::Status check_meaning(const CLI::App& command, const GateCommand& c) {
  const auto given = [&](const std::vector<std::string>& flags) { return first_given(command, flags); };
  if (!c.write_baseline.empty()) {
    if (!given({"--baseline", "--against"}).empty())
      return invalid_input("--write-baseline compares nothing: leave out --baseline and --against");
    if (const std::string flag = given({"--tolerance", "--cpu-tolerance", "--noise", "--json"});
        !flag.empty())
      return invalid_input("{}: --write-baseline compares nothing; {} goes with --baseline", flag, flag);
  }
  if (!c.against.other.empty()) {
    if (!c.baseline.empty()) return invalid_input("--baseline and --against exclude one another");
    if (!c.noise.empty()) return invalid_input("--noise is for --baseline: --against measures its own noise");
    if (!given({"--region"}).empty())
      return invalid_input("--region: gate compares whole pictures; --crop renders a part");
    return absl::OkStatus();
  }
  std::vector<std::string> rendering = job_flags();
  rendering.insert(rendering.end(), {"--rounds", "--workers", "--threads"});
  if (const std::string flag = given(rendering); !flag.empty())
    return invalid_input("{}: {} takes finished runs; options of render go with --against", flag,
                         c.write_baseline.empty() ? "--baseline" : "--write-baseline");
  return absl::OkStatus();
}

absl::StatusOr<GateResult> gate(GateCommand& c, std::stop_token stop) {
  ASSIGN_OR_RETURN(const GateOptions options, gate_options(c));
  if (!c.against.other.empty()) {
    if (!c.rounds.empty()) {
      ASSIGN_OR_RETURN(const int64_t rounds, parse_whole("--rounds", c.rounds, 2, kMostRounds));
      c.against.rounds = static_cast<int>(rounds);
    }
    return gate_against(c.against, options, stop);
  }
  if (c.baseline.empty())
    return invalid_input("gate: nothing to compare with: give --baseline base.json or --against BUILD_DIR");
  ASSIGN_OR_RETURN(const Json now, read_json(c.against.job.scene));
  ASSIGN_OR_RETURN(const Json before, read_json(c.baseline));
  return gate_runs(now, c.against.job.scene, before, c.baseline, options);
}

absl::Status write_baseline(const GateCommand& c) {
  ASSIGN_OR_RETURN(const Json run, read_json(c.against.job.scene));
  ASSIGN_OR_RETURN(const Json baseline, baseline_of(run, c.against.job.scene));
  return write_file_atomically(c.write_baseline, baseline.dump() + '\n');
}

int exit_code_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return kExitDone;
    case Verdict::kWorse:
      return kExitWorse;
    case Verdict::kInconclusive:
      return kExitInconclusive;
  }
  std::abort();
}

void add_options(CLI::App& command, GateCommand& c) {
  add_job_options(command, c.against.job);
  command.get_option("scene")
      ->type_name("RUN.json|SCENE.pbrt")
      ->description("run.json of a run (with --baseline), or a scene (with --against)");
  command.add_option("--baseline", c.baseline, "run.json of an earlier run, or what --write-baseline wrote")
      ->type_name("BASE.json");
  command
      .add_option("--against", c.against.other,
                  "Folder of another build: both render SCENE.pbrt in turns on this machine. Options of "
                  "render say what; --budget and --spp are those of one round")
      ->type_name("BUILD_DIR");
  command.add_option("--rounds", c.rounds, "Rounds of --against (default 8)")->type_name("N");
  command.add_option("--tolerance", c.tolerance, "How much worse is still a pass")
      ->type_name("PERCENT")
      ->capture_default_str();
  command.add_option("--cpu-tolerance", c.cpu_tolerance, "The same for CPU per pass (default: --tolerance)")
      ->type_name("PERCENT");
  command.add_option("--noise", c.noise, "What `penumbra calibrate --json` printed on this machine")
      ->type_name("NOISE.json");
  command
      .add_option("--write-baseline", c.write_baseline,
                  "Only write what a gate needs of RUN.json: to be kept with a project")
      ->type_name("BASE.json");
  command.add_flag("--json", c.json, "As JSON");
  command.add_flag("--quiet", c.against.quiet, "No progress");
  add_cluster_options(command, c.against.cluster);
  refuse_empty_values(command);
}

}  // namespace

void add_gate(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand(
      "gate", "Has error or CPU per pass become worse? Exit code 0: pass, 3: worse, 4: inconclusive");
  auto options = std::make_shared<GateCommand>();
  add_options(*command, *options);
  command->callback([command, options, &chosen] {
    chosen.run = [command, options](std::stop_token stop) {
      if (const absl::Status status = check_meaning(*command, *options); !status.ok()) return tell(status);
      if (!options->write_baseline.empty()) return tell(write_baseline(*options));
      const absl::StatusOr<GateResult> result = gate(*options, stop);
      if (!result.ok()) return tell(result.status());
      fmt::print("{}", options->json ? json_text(gate_json(*result)) : gate_text(*result));
      return exit_code_of(result->verdict);
    };
  });
}

}  // namespace penumbra
