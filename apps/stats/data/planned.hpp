#pragma once
/// Task 1: what was planned for those whose answers count.

#include "apps/stats/data/task_data.hpp"

namespace apps {

/// Gives each report its period, and lists the planned trials without a report.
void add_planned(TaskData& data);

}  // namespace apps
