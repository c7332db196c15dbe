# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The report of an evaluation: one HTML page with tables, curves and the worst frames."""

from lane_dp_ros.tools.report.page import write_report
from lane_dp_ros.tools.report.page_file import check_report_output
from lane_dp_ros.tools.report.surface_page import write_surface_report

__all__ = ["check_report_output", "write_report", "write_surface_report"]
