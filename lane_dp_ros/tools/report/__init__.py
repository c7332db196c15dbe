# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The report of an evaluation, or of what changed between two: one HTML page with pictures and tables."""

from lane_dp_ros.tools.report.changes_page import write_changes_report
from lane_dp_ros.tools.report.page import write_report
from lane_dp_ros.tools.report.page_file import check_report_output
from lane_dp_ros.tools.report.surface_page import write_surface_report

__all__ = ["check_report_output", "write_changes_report", "write_report", "write_surface_report"]
