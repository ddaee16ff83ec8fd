#pragma once
// Memory in pages of 2 MiB. A scene's arrays are large and are filled once, so with pages of 4 KiB
// two fifths of the time of loading went into handing out pages.

namespace mirage {

/// Starts the program anew, once, with an allocator that asks the kernel for huge pages. Nothing
/// happens where the kernel gives them unasked or never, where the user has set GLIBC_TUNABLES, or
/// where the program cannot find itself. Call it first of all: what was read from a pipe is gone.
void use_huge_pages(char** argv);

}  // namespace mirage
