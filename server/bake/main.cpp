// mirage-bake: options -> scene -> subjects -> captures -> files (bake_run.h).

#include "protocol/base/fail.h"
#include "protocol/base/resources.h"
#include "server/bake/bake_run.h"

int main(int argc, char** argv) {
  return mirage::run_program([&] {
    mirage::BakeOptions options;
    if (const int code = mirage::parse_options(argc, argv, options); code >= 0) return code;
    mirage::Result<void> done = mirage::require_threads();
    if (done) done = mirage::run_bake(options);
    return done.ok() ? 0 : mirage::fail(done.error());
  });
}
