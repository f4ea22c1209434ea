// SPDX-License-Identifier: Apache-2.0
// fuzz_readers [MUTATIONS [SEED [KIND]]]: every reader on that many damaged files of each kind, or
// of the one kind (obj, ply_text, ..., head, touch, tissue). Build it with the asan preset (`make
// fuzz`); whatever a sanitizer or an unexpected exception finds ends the run. The same seed gives
// the same files on every machine.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <functional>

#include "core/error.hpp"
#include "haptics/tick.hpp"
#include "io/head_file.hpp"
#include "io/tissue_formats.hpp"
#include "samples.hpp"

using namespace palpate;
using namespace palpate::io;

namespace {

/// @returns false where the file was refused; anything but InputError is a find
bool accepts(const std::function<void(const std::string&)>& read, const std::string& bytes) {
  try {
    read(bytes);
    return true;
  } catch (const InputError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos)
      throw std::logic_error(std::string("more than one line: ") + error.what());
    return false;
  }
}

// What is read must also bear a touch, or be refused by then.
void touch(const std::string& bytes) {
  using namespace palpate::haptics;
  const TouchModel model = make_touch_model(parse_head(bytes, "fuzz"));
  const TickSetup setup = make_tick_setup(model, unlimited());
  const Box box = model.mesh.tree.box();
  TickState state;
  TickInput input;
  for (int i = 0; i <= 8; ++i) {
    input.position = box.high + (box.low - box.high) * (0.125 * i);
    if (!input.position.allFinite()) return;
    if (!tick(setup, input, state).force.allFinite())
      throw std::logic_error("a force that is not finite");
  }
}

struct Job {
  long mutations;
  std::uint64_t seed;
  std::string only;
};

void fuzz(const Job& job, const std::string& label, const std::string& good,
          const std::function<void(const std::string&)>& read) {
  if (!job.only.empty() && job.only != label) return;
  const auto [mutations, seed, only] = job;
  test::Random random(seed);
  long accepted = 0;
  for (long i = 0; i < mutations; ++i) {
    const std::string bytes = test::mutated(good, random);
    try {
      accepted += accepts(read, bytes);
    } catch (const std::exception& error) {
      fmt::print("{}: mutation {} of seed {}: {}\n", label, i, seed, error.what());
      if (FILE* file = std::fopen("fuzz_find.bin", "wb")) {
        std::fwrite(bytes.data(), 1, bytes.size(), file);
        std::fclose(file);
      }
      std::exit(1);
    }
  }
  fmt::print("{:<12} {} files, {} read, {} refused\n", label, mutations, accepted,
             mutations - accepted);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Job job{argc > 1 ? std::atol(argv[1]) : 10'000,
                argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1, argc > 3 ? argv[3] : ""};
  for (const test::SampleFile& file : test::sample_files(1))
    fuzz(job, file.label, file.bytes, [&file](const std::string& bytes) {
      const ParsedMesh parsed = file.parse(Source{"fuzz", bytes, {}});
      if (const auto defect = first_defect(parsed.mesh)) throw std::logic_error(*defect);
    });
  fuzz(job, "head", head_bytes(test::sample_head(0)), [](const std::string& bytes) {
    (void)head_bytes_without_run(bytes, "fuzz");
    (void)head_bytes(parse_head(bytes, "fuzz"));
  });
  fuzz(job, "touch", head_bytes(test::sample_head(0)), touch);
  fuzz(job, "tissue", tissue_msh(test::sample_tissue()), [](const std::string& bytes) {
    (void)parse_tissue_msh({"fuzz", bytes, {}});
  });
  return 0;
}
