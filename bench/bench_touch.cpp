// SPDX-License-Identifier: GPL-3.0-or-later
// Every figure of touch as a table; a line that misses its figure begins with !!, and the exit code
// is 1.
//   bench_touch [--head head.glb] [--quick] [--priority N] [SECTION ...]
// Sections: tick slide map loop press replay; all without one. Without a head, closed-form ones.
// --quick is a tenth of the time. The loop and the timed ticks run with SCHED_FIFO N (80; 0: none).
#include <cstdlib>
#include <set>

#include "core/error.hpp"
#include "haptics/scenes.hpp"
#include "io/head_file.hpp"
#include "touch_figures.hpp"

namespace {

using namespace palpate;
using bench::Table;
using bench::TouchScene;

TouchScene scene(std::string name, TouchableHead head) {
  haptics::TouchModelOptions options;
  options.tool_radius = 5;
  haptics::TouchModel model = haptics::make_touch_model(head, options);
  return {std::move(name), std::move(model), std::move(head)};
}

struct Arguments {
  std::string head;
  bool quick = false;
  int priority = 80;
  std::set<std::string> sections;
  [[nodiscard]] bool wants(const char* section) const {
    return sections.empty() || sections.contains(section);
  }
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--quick")
      a.quick = true;
    else if (word == "--head" && i + 1 < argc)
      a.head = argv[++i];
    else if (word == "--priority" && i + 1 < argc)
      a.priority = std::atoi(argv[++i]);
    else
      a.sections.insert(word);
  }
  return a;
}

void run(const Arguments& a, Table& table) {
  const double part = a.quick ? 0.1 : 1;
  if (a.wants("tick") || a.wants("slide"))
    for (const int n : {50, 112, 354}) {  // 20, 100, 1000 thousand triangles
      const TouchScene bumpy =
          scene(fmt::format("bumpy head, {} triangles", 8 * n * n), haptics::scenes::bumpy_head(n));
      if (a.wants("tick")) bench::time_ticks(bumpy, 200'000, a.priority, table);
      if (a.wants("slide")) bench::measure_slide(bumpy, table);
    }
  const TouchScene main = a.head.empty() ? scene("bumpy head", haptics::scenes::bumpy_head(112))
                                         : scene(a.head, io::read_head(a.head));
  if (!a.head.empty()) {
    if (a.wants("tick")) bench::time_ticks(main, 200'000, a.priority, table);
    if (a.wants("slide")) bench::measure_slide(main, table);
  }
  if (a.wants("map")) bench::compare_with_map(main, a.quick ? 20 : 200, table);
  if (a.wants("loop")) bench::keep_time(main, static_cast<int>(60 * part), a.priority, table);
  if (a.wants("replay")) bench::replay_recording(main, 600 * part, table);
  if (a.wants("press")) bench::press_everywhere(main, 600 * part, table);
}

}  // namespace

int main(int argc, char** argv) {
  Table table;
  try {
    run(parse(argc, argv), table);
  } catch (const std::exception& e) {
    fmt::print(stderr, "bench_touch: {}\n", e.what());
    return 2;
  }
  return table.missed() > 0 ? 1 : 0;
}
