#include <rayloom/tools/bench/peer_embree.h>

#include <rayloom/base/error.h>

namespace rayloom::bench {

std::string embree_version() { return ""; }

std::unique_ptr<Peer> make_embree(const PeerScene&, const EmbreeOptions&) {
  throw InputError("this rayloom was built without Embree; install the Debian package libembree-dev and build again");
}

}  // namespace rayloom::bench
