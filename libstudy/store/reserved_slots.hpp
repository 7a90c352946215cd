#pragma once
/// Slots of the assignment (places in the counterbalancing, libstudy/design/plan.hpp) that a central database
/// deals to several stations, one by one or in blocks in advance.
///
/// A station stores each request with a random token before it sends it, and each slot before a session takes
/// it. A session stores the name of its slot (SessionPlan::reservation). A reserved slot is free while no
/// session that counts (Store::taken_slots()) has its name: a slot of a person who dropped out or withdrew is
/// free again. A slot that is to be returned is marked here before the central database is told. So a cut at
/// any instant leaves no slot to two people, and none to nobody once the station is online again.

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libstudy/store/store.hpp"
#include "libstudy/store/study_file.hpp"
#include "stats/base/error.hpp"

namespace study {

/// A request for slots of one protocol.
struct SlotRequest {
  std::string service;  ///< name of the central database
  std::string protocol_sha256;
  int slots = 1;       ///< slot_count() of the protocol
  int wanted = 1;      ///< number of slots, 1 to most_wanted_slots
  bool block = false;  ///< true: reserved in advance; false: asked for by a run
};

inline constexpr int most_wanted_slots = 10000;

/// The state of a reserved slot: the answer did not come yet; a session has it or may take it; it is
/// released, and the central database does not know yet; it does.
enum class SlotState { Asked, Held, Returning, Returned };

struct ReservedSlot {
  std::string token;
  int place = 0;  ///< 0-based, in its request
  std::string service, protocol_sha256;
  int slots = 1;
  bool block = false;
  int slot = -1;  ///< -1: the answer did not come yet
  SlotState state = SlotState::Asked;
  std::string asked_utc;
  std::string taken_by;   ///< participant whose session has it and counts; empty: nobody
  bool given_up = false;  ///< true: sessions had it, and none of them counts any more

  /// The name that a session stores: token, full stop, place.
  std::string name() const { return token + "." + std::to_string(place); }
  bool is_free() const { return state == SlotState::Held && taken_by.empty(); }
};

/// Store::reserved_slots() of a database that is not open. base::Error as open_study().
std::vector<ReservedSlot> read_reserved_slots(const StudyFile& study);

/// The central database, as far as it deals slots.
class SlotServer {
 public:
  virtual ~SlotServer() = default;
  /// The slots of a request by place: the lowest of those that sessions and open reservations use least. The
  /// same slots for the same token. ServerUnreachable if the server cannot be reached or the connection was
  /// cut; the request may have been granted then. base::Error if the server refuses.
  virtual std::vector<int> reserve(const std::string& token, const SlotRequest& request) = 0;
  /// Returns these places of a request; those that were returned before are skipped. Throws as reserve().
  virtual void give_back(const std::string& token, const std::vector<int>& places) = 0;
};

/// The central database cannot be reached, or the connection was cut.
class ServerUnreachable : public base::Error {
 public:
  ServerUnreachable(const std::string& place, const std::string& problem, const std::string& mend)
      : Error(place, problem, mend), problem_(problem) {}
  const std::string& problem() const { return problem_; }

 private:
  std::string problem_;
};

/// Makes a connection; ServerUnreachable if it cannot be made.
using SlotConnection = std::function<std::unique_ptr<SlotServer>()>;

/// A slot for a session, with the name of its reservation.
struct DealtSlot {
  int slot = 0;
  std::string reservation;
};

/// Slots for the sessions that a run plans (SlotRequest::wanted of them). Takes the free ones that an earlier
/// run asked for, then asks the server for the rest. If the server cannot be reached, takes free slots that
/// were reserved in advance, in their order, and says why in `offline`; base::Error if they are too few.
std::vector<DealtSlot> deal_slots(Store& store, const SlotConnection& connect, const SlotRequest& request,
                                  std::string& offline);

/// Reserves request.wanted slots in advance and returns them. First sends requests of the service again whose
/// answer did not come. Throws as SlotServer::reserve(); what was asked stays stored then.
std::vector<int> reserve_block(Store& store, SlotServer& server, const SlotRequest& request);

/// What settle_slots() did.
struct SettledSlots {
  int answered = 0;  ///< slots of requests whose answer had not come before
  int returned = 0;
};

/// True if settle_slots() has something to do for the service.
bool needs_settling(const std::vector<ReservedSlot>& slots, const std::string& service);

/// Sends requests of the service again whose answer did not come, and returns slots that are free because a
/// session does not count any more, or because a run did not take what it asked for. all: also returns the
/// free slots that were reserved in advance. Push the sessions first. Throws as SlotServer; what was done
/// stays done, and a later call does the rest.
SettledSlots settle_slots(Store& store, SlotServer& server, const std::string& service, bool all = false);

}  // namespace study
