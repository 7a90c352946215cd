#pragma once
/// Task 1: the planned trials of the analysed participants.

#include "libstudy/analysis/task_data.hpp"

namespace study {

/// Sets the period of each report, and lists the planned trials without a report.
void add_planned(TaskData& data);

}  // namespace study
