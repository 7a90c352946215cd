#include "libstudy/store/read/stored_protocol.hpp"

namespace study {

namespace {

using sqlite::Connection;
using sqlite::Statement;

bool first_format(Connection& database, std::int64_t protocol_id) {
  Statement row(database,
                "SELECT EXISTS (SELECT 1 FROM cell WHERE protocol_id = ?1) AND "
                "NOT EXISTS (SELECT 1 FROM cell WHERE protocol_id = ?1 AND method <> '')");
  row.bind_all(protocol_id).step();
  return row.integer(0) != 0;
}

void add_cells(Connection& database, std::int64_t protocol_id, Design& design) {
  Statement row(database,
                "SELECT cell, mean_fps, sd_fps, duration_s FROM cell WHERE protocol_id = ? ORDER BY cell");
  row.bind_all(protocol_id);
  while (row.step()) {
    design.cells.resize(static_cast<std::size_t>(row.integer(0)) + 1);
    design.cells.back().setting = {row.real(1), row.real(2), row.real(3)};
  }
}

/// Every question of the first format was on a scale, asked after each trial.
Block trials(Connection& database, std::int64_t protocol_id) {
  Block block;
  block.kind = BlockKind::Stimulus;
  TrialStep ask;
  ask.kind = StepKind::Ask;
  Statement row(database,
                "SELECT code, wording, language, scale_min, scale_max FROM question WHERE protocol_id = ? "
                "ORDER BY question_id");
  row.bind_all(protocol_id);
  while (row.step()) {
    Question question;
    question.id = row.text(0);
    question.text = row.text(1);
    question.language = row.text(2);
    question.scale_min = static_cast<int>(row.integer(3));
    question.scale_max = static_cast<int>(row.integer(4));
    ask.asks.push_back(question.id);
    block.questions.push_back(std::move(question));
  }
  block.steps.push_back(ask);
  return block;
}

}  // namespace

Protocol stored_protocol(Connection& database, std::int64_t protocol_id, const std::string& where) {
  Statement row(database,
                "SELECT name, version, sha256, test_data, text, trial_seconds FROM protocol WHERE "
                "protocol_id = ?");
  row.bind_all(protocol_id).step();
  if (!first_format(database, protocol_id)) {
    Protocol protocol = parse_protocol(row.text(4), where + ", protocol " + row.text(0), ProtocolUse::Stored);
    if (!row.is_null(5)) override_trial_seconds(protocol, row.real(5));
    return protocol;
  }
  Protocol protocol;
  protocol.name = row.text(0);
  protocol.version = row.text(1);
  protocol.sha256 = row.text(2);
  protocol.test_data = row.integer(3) != 0;
  protocol.participants = 0;
  add_cells(database, protocol_id, protocol.design);
  protocol.blocks.push_back(trials(database, protocol_id));
  return protocol;
}

}  // namespace study
