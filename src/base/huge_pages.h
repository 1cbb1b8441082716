#pragma once

namespace faceta {

/// Asks the system to put the large, filled blocks of this process's heap on huge pages, now.
/// Containers choose them by HugeVector; this is for memory that a library took, such as Embree's
/// tree: walked at random beside tens of megabytes of textures, it otherwise pays for an address
/// translation at every step. A hint: where the system cannot, nothing changes. Linux only.
void prefer_huge_pages();

} // namespace faceta
