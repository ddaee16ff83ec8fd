#include "client/report/weather_rows.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>

namespace mirage {
namespace {

Weather weather(const char* name, const char* scene, const char* path, const NetModel& net) {
  return {name, scene, std::string("builtin:") + path, net};
}

NetModel link(double rtt, double jitter, double rate, double loss = 0, double server = 5) {
  NetModel net;
  net.rtt_ms = rtt;
  net.jitter_ms = jitter;
  net.rate_mbps = rate;
  net.loss_percent = loss;
  net.server_ms = server;
  return net;
}

// Without its options.
std::string base_of(const std::string& scene) { return scene.substr(0, scene.find('?')); }

// Median of the finite values; the mean of the two in the middle for an even number of them.
double median(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
               values.end());
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

double most(std::vector<double> values) {
  double out = NAN;
  for (const double v : values) out = std::fmax(out, v);
  return out;
}

double least(std::vector<double> values) {
  double out = NAN;
  for (const double v : values) out = std::fmin(out, v);
  return out;
}

double sum(std::vector<double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// A column of the table: what of a run, what of the seeds of a weather, what is worst of several.
struct Column {
  using Pick = double (*)(std::vector<double>);
  const char* name;
  std::function<double(const WeatherRun&)> value;
  Pick over_seeds, worst;
};

const std::vector<Column>& columns() {
  using Run = WeatherRun;
  static const std::vector<Column> list = {
      {"FLIP", [](const Run& r) { return r.flip_mean; }, median, most},
      {"FLIP, worst seed", [](const Run& r) { return r.flip_mean; }, most, most},
      {"FLIP, worst frame", [](const Run& r) { return r.flip_worst; }, most, most},
      {"PSNR, dB", [](const Run& r) { return r.psnr_db; }, median, least},
      {"holes", [](const Run& r) { return r.hole_fraction; }, median, most},
      {"no image", [](const Run& r) { return r.no_image_fraction; }, median, most},
      {"starved", [](const Run& r) { return r.starved_fraction; }, median, most},
      {"MB", [](const Run& r) { return r.mb; }, median, most},
      {"link used", [](const Run& r) { return r.link_used; }, median, most},
      {"client ms p95", [](const Run& r) { return r.client_ms_p95; }, median, most},
      {"over bound, px", [](const Run& r) { return static_cast<double>(r.bound_violations); }, sum,
       most}};
  return list;
}

std::string words(const NetModel& net) {
  return fmt::format("RTT {:g} ± {:g} ms, {:g} Mbit/s, {:g} % lost, {:g} ms a tile", net.rtt_ms,
                     net.jitter_ms, net.rate_mbps, net.loss_percent, net.server_ms);
}

// Runs of one weather together, in the order of the table.
std::vector<std::vector<const WeatherRun*>> by_weather(const std::vector<WeatherRun>& runs) {
  std::vector<std::vector<const WeatherRun*>> out;
  for (const WeatherRun& run : runs) {
    const auto at = std::find_if(out.begin(), out.end(), [&](const auto& group) {
      return group.front()->weather.name == run.weather.name;
    });
    if (at == out.end()) {
      out.push_back({&run});
    } else {
      at->push_back(&run);
    }
  }
  return out;
}

std::string rounded(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : figure(value);
}

}  // namespace

std::vector<Weather> weathers_on(const std::string& scene) {
  const char *forest = "builtin:forest", *clutter = "builtin:clutter";
  std::vector<Weather> list = {
      weather("lab", forest, "walk", link(100, 0, 20)),
      weather("office", forest, "walk", link(100, 20, 20)),
      weather("mobile", forest, "walk", link(60, 25, 12, 0.3)),
      weather("slow-server", forest, "walk", link(20, 2, 100, 0, 20)),
      weather("wifi-strafe", forest, "strafe", link(40, 15, 50, 0.1)),
      weather("thin-room", clutter, "walk", link(50, 10, 2)),
      weather("teleport-room", clutter, "teleport", link(150, 10, 50)),
      weather("satellite-city", "builtin:city", "fly", link(400, 60, 5, 0.5)),
      weather("big-field", "builtin:field?instances=100000", "walk", link(60, 10, 20)),
      weather("shake", forest, "shake", link(50, 10, 20))};
  if (scene.empty()) return list;
  list.erase(std::remove_if(list.begin(), list.end(),
                            [&](const Weather& w) { return base_of(w.scene) != base_of(scene); }),
             list.end());
  for (Weather& w : list) w.scene = scene;
  return list;
}

std::string seeded(const std::string& scene, std::uint64_t seed) {
  return scene.find('?') == std::string::npos ? fmt::format("{}?seed={}", scene, seed) : scene;
}

Table weather_csv(const std::vector<WeatherRun>& runs) {
  Table table({"weather",
               "scene",
               "path",
               "seed",
               "rtt_ms",
               "jitter_ms",
               "rate_mbps",
               "loss_pct",
               "server_ms",
               "flip_mean",
               "flip_worst",
               "psnr_db",
               "hole_fraction",
               "no_image_fraction",
               "starved_fraction",
               "mb",
               "link_used",
               "bound_violations",
               "budget_ms",
               "client_ms_p95"});
  for (const WeatherRun& run : runs) {
    const NetModel& net = run.weather.net;
    table.add({run.weather.name,
               seeded(run.weather.scene, run.seed),
               run.weather.path,
               std::to_string(run.seed),
               figure(net.rtt_ms),
               figure(net.jitter_ms),
               figure(net.rate_mbps),
               figure(net.loss_percent),
               figure(net.server_ms),
               figure(run.flip_mean),
               figure(run.flip_worst),
               figure(run.psnr_db),
               figure(run.hole_fraction),
               figure(run.no_image_fraction),
               figure(run.starved_fraction),
               figure(run.mb),
               figure(run.link_used),
               std::to_string(run.bound_violations),
               figure(run.budget_ms),
               figure(run.client_ms_p95)});
  }
  return table;
}

Table weather_table(const std::vector<WeatherRun>& runs) {
  std::vector<std::string> names = {"weather", "scene", "path", "link"};
  for (const Column& column : columns()) names.push_back(column.name);
  Table table(names);
  std::vector<std::vector<double>> all(columns().size());  // a value for each weather
  for (const auto& group : by_weather(runs)) {
    const Weather& w = group.front()->weather;
    std::vector<std::string> row = {w.name, w.scene, w.path, words(w.net)};
    for (std::size_t c = 0; c < columns().size(); ++c) {
      std::vector<double> values;
      for (const WeatherRun* run : group) values.push_back(columns()[c].value(*run));
      all[c].push_back(columns()[c].over_seeds(values));
      row.push_back(rounded(all[c].back()));
    }
    table.add(row);
  }
  std::vector<std::string> middle = {"median", "", "", ""}, worst = {"worst", "", "", ""};
  for (std::size_t c = 0; c < columns().size(); ++c) {
    middle.push_back(rounded(median(all[c])));
    worst.push_back(rounded(columns()[c].worst(all[c])));
  }
  table.add(middle);
  table.add(worst);
  return table;
}

Table weather_budget_table(const std::vector<WeatherRun>& runs) {
  const Column columns[] = {
      {"FLIP", [](const WeatherRun& r) { return r.flip_mean; }, median, most},
      {"FLIP, worst seed", [](const WeatherRun& r) { return r.flip_mean; }, most, most},
      {"MB", [](const WeatherRun& r) { return r.mb; }, median, most},
      {"client ms p95", [](const WeatherRun& r) { return r.client_ms_p95; }, median, most}};
  std::vector<std::string> names = {"weather"};
  for (const Column& column : columns) {
    names.insert(names.end(),
                 {std::string(column.name) + ", no budget", std::string(column.name) + ", within"});
  }
  Table table(names);
  std::vector<std::vector<double>> all(names.size() - 1);  // a value for each weather
  for (const auto& group : by_weather(runs)) {
    std::vector<std::string> row = {group.front()->weather.name};
    std::size_t i = 0;
    for (const Column& column : columns) {
      std::vector<double> free, held;
      for (const WeatherRun* run : group) {
        (run->budget_ms > 0 ? held : free).push_back(column.value(*run));
      }
      for (const std::vector<double>* values : {&free, &held}) {
        all[i].push_back(column.over_seeds(*values));
        row.push_back(rounded(all[i++].back()));
      }
    }
    table.add(row);
  }
  std::vector<std::string> middle = {"median"}, worst = {"worst"};
  for (const std::vector<double>& values : all) {
    middle.push_back(rounded(median(values)));
    worst.push_back(rounded(most(values)));
  }
  table.add(middle);
  table.add(worst);
  return table;
}

std::vector<Panel> weather_panels(const std::vector<WeatherRun>& runs) {
  std::vector<Panel> panels;
  for (const auto& group : by_weather(runs)) {
    const Weather& w = group.front()->weather;
    std::map<double, std::vector<double>> at;  // FLIP of the seeds, by second
    for (const WeatherRun* run : group) {
      for (const auto& [seconds, flip] : run->flip) at[seconds].push_back(flip);
    }
    Series series{w.name, {}};
    for (const auto& [seconds, flips] : at) series.points.emplace_back(seconds, median(flips));
    const auto same = [&](const Panel& panel) { return panel.title == w.scene; };
    auto panel = std::find_if(panels.begin(), panels.end(), same);
    if (panel == panels.end()) {
      panels.push_back(
          {w.scene, "seconds since the scene is known", "FLIP", false, false, {}, {}, {}});
      panel = panels.end() - 1;
    }
    panel->series.push_back(std::move(series));
  }
  return panels;
}

}  // namespace mirage
