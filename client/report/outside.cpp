#include "client/report/outside.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

namespace mirage {
namespace {

using nlohmann::ordered_json;

constexpr const char* kFoundFile = "extreme.found.json";

std::string cell(const ordered_json& row, const std::string& key) {
  const auto at = row.find(key);
  if (at == row.end() || at->is_null()) return "n/a";
  if (at->is_string()) return at->get<std::string>();
  if (at->is_boolean()) return at->get<bool>() ? "pass" : "FAIL";
  if (at->is_number_float()) return figure(at->get<double>());
  return at->dump();
}

// Returns the "rows" of a program's output; nullopt: the output is not as expected.
std::optional<std::vector<ordered_json>> rows_of(const std::string& text) {
  const ordered_json parsed = ordered_json::parse(text, nullptr, false);
  if (!parsed.is_object() || !parsed.contains("rows") || !parsed["rows"].is_array()) {
    return std::nullopt;
  }
  std::vector<ordered_json> rows;
  for (const ordered_json& row : parsed["rows"]) {
    if (!row.is_object()) return std::nullopt;
    rows.push_back(row);
  }
  return rows;
}

Table table_of(const std::vector<ordered_json>& rows, const std::vector<std::string>& columns) {
  Table table(columns);
  for (const ordered_json& row : rows) {
    std::vector<std::string> cells;
    for (const std::string& column : columns) cells.push_back(cell(row, column));
    table.add(std::move(cells));
  }
  return table;
}

Result<void> write_rows(const Context& context, const std::string& file,
                        const std::vector<ordered_json>& rows) {
  const std::string text =
      ordered_json{{"rows", rows}}.dump(1, ' ', false, ordered_json::error_handler_t::replace);
  return write_file(context.path(file), text + "\n");
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  if (end == std::string::npos) return "it said nothing";
  const std::size_t start = text.find_last_of('\n', end);
  return text.substr(start == std::string::npos ? 0 : start + 1,
                     end - (start == std::string::npos ? 0 : start + 1) + 1);
}

}  // namespace

ExtremeRun start_extreme(const Context& context) {
  const std::optional<std::string> program = sibling_program("mirage-extreme");
  if (!program) return {};
  const std::string jobs = std::to_string(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<std::string> command = {*program, "--json", context.path(kFoundFile)};
  if (context.options.quick) command.push_back("--quick");
  command.insert(command.end(), {"--jobs", jobs});
  return std::async(std::launch::async, [command, progress = context.progress]() mutable {
    const Result<ChildResult> listed = run_child({command[0], "--list"});
    if (!listed) return listed;
    progress.begin("extreme", lines_of(listed->out));
    ChildWatch watch;
    watch.on_out = [&](const std::string& line) {
      // A verdict is "ID pass" or "ID FAIL", before what was measured.
      constexpr std::size_t kVerdict = 9;
      if (line.find(" pass ") < kVerdict || line.find(" FAIL ") < kVerdict)
        progress.step(line.substr(0, kVerdict));
    };
    return run_child(command, watch);
  });
}

Result<void> report_extreme(Context& context, ExtremeRun run) {
  Page& page = context.page;
  page.section("extreme", "Stiff and extreme cases");
  std::vector<ordered_json> rows;
  if (!run.valid()) {
    context.omit("extreme", "all cases", "there is no mirage-extreme beside mirage-report");
    return write_rows(context, "extreme.json", rows);
  }
  const std::string file = context.path(kFoundFile);
  const Result<ChildResult> ran = run.get();
  if (!ran) return ran.error();
  const auto found = rows_of(read_file(file));
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  if (!found) {
    context.omit("extreme", "all cases",
                 fmt::format("mirage-extreme ended with exit code {}: {}", ran->exit_code,
                             last_line(ran->err)));
    return write_rows(context, "extreme.json", rows);
  }
  rows = *found;
  std::vector<bool> failed;
  std::size_t passed = 0;
  for (const ordered_json& row : rows) {
    const bool pass = row.value("pass", false);
    failed.push_back(!pass);
    passed += pass;
    if (!pass)
      context.failed_checks.push_back("extreme case " + cell(row, "id") + " does not hold");
  }
  page.command("mirage-extreme --json extreme.json" +
               std::string(context.options.quick ? " --quick" : ""));
  page.finding({fmt::format("{} of {}", passed, rows.size()), "cases hold", passed < rows.size()});
  for (const ordered_json& row : rows) {
    if (!row.value("pass", false)) page.falls_short(cell(row, "id") + ": " + cell(row, "case"));
  }
  page.table(table_of(rows, {"id", "case", "must_hold", "measured", "limit", "pass"}), failed);
  return write_rows(context, "extreme.json", rows);
}

Result<void> report_needs(Context& context) {
  Page& page = context.page;
  page.section("needs", "What scenes do not need");
  const std::optional<std::string> program = sibling_program("mirage-server");
  std::vector<std::string> scenes = {"builtin:forest?trees=60", "builtin:clutter?objects=150",
                                     "builtin:knot"};
  if (!context.options.quick)
    scenes = {"builtin:forest", "builtin:clutter", "builtin:city", "builtin:knot"};
  if (!context.options.scene.empty()) scenes = {context.options.scene};
  std::vector<ordered_json> rows;
  context.progress.begin("needs", scenes.size());
  for (const std::string& scene : scenes) {
    context.progress.step(scene);
    if (!program) {
      context.omit("needs", scene, "there is no mirage-server beside mirage-report");
      continue;
    }
    std::vector<std::string> command = {*program, scene, "--explain", "--prove", "--json"};
    const std::vector<std::string> few = {"--prove-cells", "2", "--prove-objects", "1"};
    if (context.options.quick) command.insert(command.end(), few.begin(), few.end());
    const Result<ChildResult> ran = run_child(command);
    if (!ran) return ran.error();
    const auto found = rows_of(ran->out);
    if (ran->exit_code != 0 || !found) {
      context.omit("needs", scene,
                   fmt::format("mirage-server --explain --prove --json ended with exit code {}: {}",
                               ran->exit_code, last_line(ran->err)));
      continue;
    }
    rows.insert(rows.end(), found->begin(), found->end());
    const ordered_json whole = ordered_json::parse(ran->out, nullptr, false);
    page.command("mirage-server '" + scene + "' --explain --prove" +
                 (context.options.quick ? " --prove-cells 2 --prove-objects 1" : ""));
    if (whole.contains("total")) page.method("In all: " + whole["total"].dump());
  }
  std::vector<bool> differing;
  for (const ordered_json& row : rows) {
    const bool same = row.contains("differing_components") && row["differing_components"] == 0;
    differing.push_back(!same);
    if (same) continue;
    context.failed_checks.push_back(
        fmt::format("{}, {}, {}: {} components differ when left out", cell(row, "scene"),
                    cell(row, "object"), cell(row, "rule"), cell(row, "differing_components")));
  }
  if (!rows.empty()) {
    const auto wrong = std::count(differing.begin(), differing.end(), true);
    page.finding({std::to_string(rows.size()), "features left out of an object"});
    page.finding({std::to_string(wrong), "of them change a byte of a tile", wrong > 0});
    page.method("Each object is drawn with and without what is left out; every byte is compared.");
    page.table(
        table_of(rows, {"scene", "object", "rule", "left_out", "differing_components", "saved"}),
        differing);
  }
  return write_rows(context, "needs.json", rows);
}

}  // namespace mirage
