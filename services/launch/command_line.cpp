#include "launch/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <new>
#include <sstream>

#include "exchange/link.hpp"
#include "launch/bench_command.hpp"
#include "launch/check.hpp"
#include "launch/init.hpp"
#include "launch/new_file.hpp"
#include "launch/point.hpp"
#include "launch/run.hpp"
#include "process/nearest.hpp"
#include "scene/read_scene.hpp"
#include "scene/reference.hpp"

namespace interply::launch {
namespace {

constexpr const char* kFooter = R"(exit codes:
  0  done
  1  interply itself failed (a file that cannot be written, a program that cannot be started)
  2  the scene, the law or the command line is refused; nothing was started
  3  the mechanics diverged; the record holds every complete frame
  4  a process was lost, or ended by a law of the user's own; the record holds every complete frame
  5  cancelled (Ctrl-C); the record holds every complete frame

`interply COMMAND --help` shows an example of each command.)";

std::vector<std::string> list_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* option : app.get_options())
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// All but those that only interply itself uses.
std::vector<std::string> list_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* command : app.get_subcommands(nullptr))
    if (!command->get_group().empty()) names.push_back(command->get_name());
  return names;
}

int refuse(const std::string& sentence) {
  std::fprintf(stderr, "interply: %s\n", sentence.c_str());
  return kRefused;
}

/// A word that names no command, or nothing; then of the command's own commands, if it has some.
std::string find_unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || app.get_subcommands(nullptr).empty()) return "";
  const std::string word = argv[1];
  if (word.starts_with("-")) {
    if (app.get_parent() || app.get_option_no_throw(word.substr(0, word.find('=')))) return "";
    return "there is no option " + word.substr(0, word.find('=')) + propose(word, list_options(app));
  }
  for (const auto* command : app.get_subcommands(nullptr))
    if (command->get_name() == word) return find_unknown_command(*command, argc - 1, argv + 1);
  return "there is no command \"" + word + "\"" + propose(word, list_commands(app), "\"");
}

/// What a command was given and does not know, or nothing.
std::string find_unknown_word(const CLI::App& command) {
  const auto words = command.remaining();
  if (words.empty()) return "";
  const auto option = std::find_if(words.begin(), words.end(), [](const auto& w) { return w.starts_with("-"); });
  if (option == words.end()) return command.get_name() + " takes no further argument \"" + words.front() + "\"";
  const std::string name = option->substr(0, option->find('='));
  return command.get_name() + " has no option " + name + propose(name, list_options(command));
}

/// The same of the command that was parsed and of its own command.
std::string find_unknown_words(const CLI::App& app) {
  for (const auto* command : app.get_subcommands()) {
    if (const auto problem = find_unknown_word(*command); !problem.empty()) return problem;
    if (const auto problem = find_unknown_words(*command); !problem.empty()) return problem;
  }
  return "";
}

template <class Values>
void add_repeatable(CLI::App& command, const char* name, Values& values, const char* help, const char* type) {
  command.add_option(name, values, help)->type_name(type)->expected(1)->take_all()->allow_extra_args(false);
}

/// @param options  of a command that takes a scene
template <class Options>
void add_scene_arguments(CLI::App& command, Options& options) {
  command.add_option("scene", options.scene, "scene file (YAML)")->required()->type_name("SCENE");
  add_repeatable(command, "--with", options.overlays, "lay a file with part of a scene over it; may be repeated",
                 "FILE");
  add_repeatable(command, "--set", options.overrides, "override any key of the scene, after that; may be repeated",
                 "PATH=VALUE");
}

struct PointOptions {
  std::filesystem::path law, path, out;
  std::vector<std::string> overrides;
  bool overwrite = false;
};

int point_command(const PointOptions& options) {
  if (options.out.empty()) return run_point(options.law, options.path, std::cout, std::cerr, options.overrides);
  const char* cure = "give another -o, or say --overwrite";
  if (!options.overwrite) check_is_new(options.out, cure);
  std::ostringstream result;  // a refused path leaves an earlier file alone
  const int exit_code = run_point(options.law, options.path, result, std::cerr, options.overrides);
  if (exit_code == kDone) write_new_file(options.out, result.str(), options.overwrite, cure);
  return exit_code;
}

CLI::App* add_run(CLI::App& app, RunOptions& options) {
  auto* run = app.add_subcommand("run", "form a scene: a federation of processes, a record, a summary");
  add_scene_arguments(*run, options);
  run->add_option("--out", options.out, "folder of the record (default: runs/<scene name>)")->type_name("DIR");
  run->add_flag("--overwrite", options.overwrite, "replace a record that is already there");
  run->add_flag("--in-process", options.in_process, "all participants in this process: the same bits, for debugging");
  run->add_option("--address", options.address,
                  "how processes exchange, and where: shm (shared memory), ipc (messages on this host), or "
                  "tcp://127.0.0.1:0 for any free port (default: the scene's, shm: the fastest)")
      ->type_name("ADDRESS");
  run->add_flag("--no-record", options.no_record, "compute, but keep only the summary");
  run->add_flag("--quiet", options.quiet, "print the digest and errors only");
  run->footer(R"(example:
  interply run deploy/scenes/tetrahedron_fml_coarse.yaml --set layers.ply_2.law.woven.variant=biaxial --out runs/biaxial
  interply run scene.yaml --with stiff.yaml --set layers.ply_2.law.file=laws/mine.yaml --out runs/mine
where stiff.yaml holds, for example: layers: {ply_2: {law: {file: laws/woven_stiff.yaml}}}
)");
  return run;
}

CLI::App* add_check(CLI::App& app, CheckOptions& options) {
  auto* check =
      app.add_subcommand("check", "validate a scene; show layers, interfaces, tools, steps, memory, record and time");
  add_scene_arguments(*check, options);
  check->add_flag("--json", options.json, "print all of it as JSON, every number with its unit");
  check->footer(R"(example:
  interply check deploy/scenes/tetrahedron_fml.yaml --set blank.mesh_size=5
)");
  return check;
}

CLI::App* add_point(CLI::App& app, PointOptions& options) {
  auto* point = app.add_subcommand("point", "drive one material point along a path of deformation gradients");
  point->add_option("law", options.law, "file with the `law` block of a layer (YAML)")->required()->type_name("LAW");
  point->add_option("--path", options.path, "columns F11,F12,F21,F22, or strain of a j2 law (CSV)")
      ->required()
      ->type_name("PATH");
  add_repeatable(*point, "--set", options.overrides, "override any key of the law; may be repeated", "PATH=VALUE");
  point->add_option("-o,--out", options.out, "write the response here instead of to the terminal (CSV)")
      ->type_name("FILE");
  point->add_flag("--overwrite", options.overwrite, "replace that file if it is there");
  point->footer(std::string(kPointColumns) + R"(
example:
  interply point law.yaml --path path.csv --set woven.variant=biaxial -o stress.csv
)");
  return point;
}

CLI::App* add_init(CLI::App& app, InitOptions& options) {
  auto* init = app.add_subcommand("init", "write a commented scene that runs: NAME.yaml");
  init->add_option("name", options.name, "of the scene, and of its file")->required()->type_name("NAME");
  const auto add_kind = [&](const char* flag, SceneKind kind, const char* help) {
    return init->add_flag_callback(
        flag, [&options, kind] { options.kind = kind; }, help);
  };
  auto* laminate = add_kind("--fml", SceneKind::Laminate, "a ply between two sheets (default)");
  auto* plies = add_kind("--plies", SceneKind::Plies, "two plies without metal");
  auto* sheet = add_kind("--sheet", SceneKind::Sheet, "one steel sheet");
  laminate->excludes(plies)->excludes(sheet);
  plies->excludes(sheet);
  init->footer(R"(example:
  interply init cup --fml
  interply run cup.yaml
)");
  return init;
}

CLI::App* add_schema(CLI::App& app, std::string& path) {
  auto* schema = app.add_subcommand("schema", "print the keys of a scene with default, unit, range and meaning");
  schema->add_option("path", path, "part of a scene (default: all of it)")->type_name("PATH");
  schema->footer(R"(examples:
  interply schema blank
  interply schema layers.law.woven
)");
  return schema;
}

}  // namespace

std::string propose(const std::string& word, const std::vector<std::string>& names, const std::string& quote) {
  if (const auto nearest = process::find_nearest(word, names); !nearest.empty())
    return "; did you mean " + quote + nearest + quote + "?";
  std::string known;
  for (const auto& name : names) known += (known.empty() ? "" : ", ") + name;
  return "; known: " + known;
}

int run_command_line(int argc, char** argv) {
  CLI::App app{"interply forms fibre-metal laminates as a federation of processes, one per layer.", "interply"};
  app.set_version_flag("--version", exchange::kVersion);
  app.footer(kFooter);
  app.require_subcommand(1);
  RunOptions run_options;
  CheckOptions check_options;
  PointOptions point_options;
  BenchOptions bench_options;
  InitOptions init_options;
  std::string schema_path;
  const auto* run = add_run(app, run_options);
  const auto* check = add_check(app, check_options);
  const auto* init = add_init(app, init_options);
  const auto* schema = add_schema(app, schema_path);
  add_point(app, point_options);
  const auto* bench = add_bench(app, bench_options);
  for (auto* command : app.get_subcommands(nullptr)) {
    command->allow_extras();
    for (auto* part : command->get_subcommands(nullptr)) part->allow_extras();
  }

  if (argc < 2) {
    std::fputs(app.help().c_str(), stderr);
    return kRefused;
  }
  if (const auto problem = find_unknown_command(app, argc, argv); !problem.empty()) return refuse(problem);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // help or version
    if (const auto problem = find_unknown_words(app); !problem.empty()) return refuse(problem);
    return refuse(std::string(e.what()) + " (see --help)");
  }
  if (const auto problem = find_unknown_words(app); !problem.empty()) return refuse(problem);
  const auto* command = app.get_subcommands().front();
  try {
    if (command == run) return run_command(run_options);
    if (command == check) return check_command(check_options, std::cout);
    if (command == init) return init_command(init_options, std::cout);
    if (command == schema) {
      std::cout << scene::describe_keys(schema_path);
      return kDone;
    }
    if (command == bench) return bench_command(*bench, bench_options, std::cout);
    return point_command(point_options);
  } catch (const scene::SceneError& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return kRefused;
  } catch (const record::FolderRefused& e) {
    return refuse(e.what());
  } catch (const BadArgument& e) {
    return refuse(e.what());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "interply: there is not enough memory\n");
    return kFailed;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "interply: %s\n", e.what());
    return kFailed;
  }
}

}  // namespace interply::launch
