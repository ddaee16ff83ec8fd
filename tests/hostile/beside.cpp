#include "tests/hostile/beside.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "tests/hostile/client.h"

namespace mirage::test {
namespace {

constexpr int kWarmTiles = 10, kAloneTiles = 60;
constexpr double kMegabyteInKb = 1024.0;  // in kB, the kernel's unit

double status_mb(int pid, const std::string& name) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/status");
  for (std::string word; file >> word;) {
    double kilobytes = 0;
    if (word == name && file >> kilobytes) return kilobytes / kMegabyteInKb;
  }
  return 0;
}

void forget_peak(int pid) { std::ofstream("/proc/" + std::to_string(pid) + "/clear_refs") << 5; }

void add(TileTimes& times, double ms) {
  if (ms < 0) {
    ++times.missing;
  } else {
    times.ms.insert(std::upper_bound(times.ms.begin(), times.ms.end(), ms), ms);
  }
}

}  // namespace

double TileTimes::at(double share) const {
  if (ms.empty()) return 0;
  return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1) + 0.5)];
}

double resident_mb(int pid) { return status_mb(pid, "VmRSS:"); }

Cost cost_of(const std::string& row, const Server& server, const std::function<void()>& hostile,
             const std::string& token) {
  Cost cost;
  Client good(server.port(), token);
  EXPECT_TRUE(good.greeted()) << server.log();
  if (!good.greeted()) return cost;
  for (int i = 0; i < kWarmTiles; ++i) good.tile_ms(kSmall);
  for (int i = 0; i < kAloneTiles; ++i) add(cost.alone, good.tile_ms(kSmall));
  forget_peak(server.pid());
  cost.before_mb = resident_mb(server.pid());
  std::atomic<bool> over{false};
  std::thread asking([&] {
    while (!over) {
      add(cost.beside, good.tile_ms(kSmall));
      if (cost.beside.missing > 0 && good.socket().ended()) return;
    }
  });
  hostile();
  over = true;
  asking.join();
  cost.most_mb = status_mb(server.pid(), "VmHWM:");
  // The pause lets the server free memory.
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  cost.after_mb = resident_mb(server.pid());
  std::printf(
      "%s: server %.0f MB before, %.0f at most, %.0f after; a good client's tile, p50 / p99 / "
      "most: alone %.1f / %.1f / %.1f ms, beside %.1f / %.1f / %.1f ms (%zu tiles)\n",
      row.c_str(), cost.before_mb, cost.most_mb, cost.after_mb, cost.alone.at(0.5),
      cost.alone.at(0.99), cost.alone.at(1), cost.beside.at(0.5), cost.beside.at(0.99),
      cost.beside.at(1), cost.beside.ms.size());
  return cost;
}

void expect_served(const Cost& cost, double most_ms) {
  EXPECT_EQ(cost.alone.missing + cost.beside.missing, 0);
  EXPECT_FALSE(cost.beside.ms.empty());
  EXPECT_LT(cost.beside.at(1), most_ms);
}

void at_once(std::size_t count, const std::function<void(std::size_t)>& what) {
  constexpr int kThreads = 6;
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      for (std::size_t at = next++; at < count; at = next++) what(at);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace mirage::test
