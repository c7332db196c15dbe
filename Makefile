# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
#
#   make         make the venv: lane_dp and lane_detector in .venv/bin, with ROS 2
#   make demo    render a road, play it into a running lane_detector, write pictures to demo/
#   make test    run the tests: all with the newest numpy and OpenCV, those of what Jazzy runs with Jazzy's
#   make lint    ruff, mypy, and the directions of imports
#   make docs-test  run every command line of README.md and of the quick start, installed in each of the three ways
#   make bench   measure the speed, write tables and pictures to bench/
#   make docs    build the documentation: docs/_build/index.html
#   make clean   remove all that the above made, the venvs too
#
# Each makes the venvs that it needs, once. Wanted: Linux on x86-64, make, PyPI and Python 3.10 to 3.13 with venv;
# another interpreter than python3: make test PYTHON=python3.12
# Where a ROS is sourced (ROS_DISTRO is set), that ROS, its numpy and its OpenCV are used; else the wheels from PyPI.

PYTHON ?= python3
python_version := $(shell $(PYTHON) -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null)
made := made-$(python_version)

# A world is a venv: what it pins, which extras of setup.py it takes, how the venv is made, and which tests run in it
# (all of them, with coverage, where none are named).
pins.venv := "numpy>=2" "opencv-python-headless>=5"
extras.venv := ros,test
pins.venv-jazzy := numpy==1.26.4 opencv-python-headless==4.6.0.66
extras.venv-jazzy := ros,test
tests.venv-jazzy := test/core test/messages test/ros
pins.venv-ros = "numpy==$$($(PYTHON) -c 'import numpy; print(numpy.__version__)')"
extras.venv-ros := test
options.venv-ros := --system-site-packages
# mypy's verdict depends on the types that these declare; all have wheels for every Python that we take.
pins.venv-lint := numpy==2.2.6 opencv-python-headless==5.0.0.93 rosbags==0.11.9
extras.venv-lint := lint
pins.venv-docs := "opencv-python-headless>=5"
extras.venv-docs := docs

ifdef ROS_DISTRO
    worlds := .venv-ros
else
    # numpy 1.26 has no wheels for Python 3.13 and later.
    worlds := $(strip .venv $(if $(filter 3.10 3.11 3.12,$(python_version)),.venv-jazzy))
    # The Python of the ROS wheels leaves these to its children, where they keep another venv from finding its own.
    unexport LD_LIBRARY_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE PYTHONPATH
endif
main := $(firstword $(worlds))

# Processes that share the tests: make test WORKERS=1 runs one after the other.
WORKERS ?= auto
coverage := --cov=lane_dp_ros.core --cov-report=term:skip-covered --cov-fail-under=95

export PYTHONNOUSERSITE := 1
# Have rclpy check the fields of messages, as a build of ROS with assertions does.
export ROS_PYTHON_CHECK_FIELDS := 1
pip_install := -m pip install --quiet --disable-pip-version-check --no-input

.PHONY: venv help demo docs-test test $(worlds:%=test-in-%) name-worlds lint bench docs clean check-python check-ros
.NOTPARALLEL:

venv: $(main)/$(made)
	@echo "lane_dp and lane_detector are in $(main)/bin; to call them by name alone: . $(main)/bin/activate"

help:
	@sed -n 's/^#   make/make/p' $(firstword $(MAKEFILE_LIST))

demo: $(main)/$(made)
	@$(main)/bin/lane_dp demo

# The ways in which to install: make docs-test ROUTES=pip tries one.
ROUTES ?= make pip colcon

docs-test: $(main)/$(made)
	@timeout 480 sh -c 'for route in $(ROUTES); do $(main)/bin/python .ci/docs_test.py $$route --python $(PYTHON) || exit 1; done'

test: name-worlds $(worlds:%=test-in-%)

name-worlds: | check-python
	@echo "== testing in $(worlds)$(if $(ROS_DISTRO)$(filter .venv-jazzy,$(worlds)),, \
	    only: Jazzy's numpy 1.26.4 has no wheels for Python $(python_version))"

$(worlds:%=test-in-%): test-in-%: %/$(made)
	@$*/bin/python -c 'import sys, numpy, cv2; print("== tests in $*: Python %d.%d, numpy %s, OpenCV %s" \
	    % (*sys.version_info[:2], numpy.__version__, cv2.__version__))'
	@COVERAGE_FILE=$*/coverage $*/bin/python -m pytest -n $(WORKERS) --dist loadfile $(or $(tests$*),$(coverage))

# -I: the verdict must not depend on what else is on this machine.
lint: .venv-lint/$(made)
	@.venv-lint/bin/python -I -m ruff check .
	@.venv-lint/bin/python -I -m ruff format --check .
	@.venv-lint/bin/python -I -m mypy
	@.venv-lint/bin/python -I .venv-lint/bin/lint-imports --no-cache

bench: $(main)/bench-$(python_version)
	@mkdir -p bench
	@$(main)/bin/python benchmarks/bench_shortest_paths.py
	@$(main)/bin/python benchmarks/bench_pipeline.py
	@$(main)/bin/python benchmarks/bench_node.py

docs: .venv-docs/$(made)
	@.venv-docs/bin/python -m sphinx -W --keep-going -q docs docs/_build
	@echo "docs/_build/index.html"

clean:
	rm -rf .venv .venv-* build install log demo bench docs/_build docs/_pictures *.egg-info .coverage .*_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

%/$(made): setup.py Makefile | check-python
	@echo "== making $* (once, takes a minute)"
	@$(PYTHON) -m venv --clear $(options$*) $*
	@$*/bin/python $(if $(filter .venv-lint,$*),-I) $(pip_install) $(pins$*) -e '.[$(extras$*)]'
	@touch $@

.venv-ros/$(made): | check-ros

%/bench-$(python_version): %/$(made)
	@$*/bin/python $(pip_install) $(pins$*) -e '.[bench]'
	@touch $@

check-python:
	@command -v $(PYTHON) >/dev/null || { \
	    echo "$(PYTHON) is not installed: name a Python from 3.10 to 3.13, such as make PYTHON=python3.12" >&2; exit 1; }
	@case "$(python_version)" in 3.10|3.11|3.12|3.13) ;; *) \
	    echo "$(PYTHON) is Python $(python_version): lane_dp_ros needs 3.10 to 3.13, such as make PYTHON=python3.12" >&2; exit 1; esac

check-ros:
	@$(PYTHON) -c 'import rclpy, sensor_msgs, numpy, cv2' 2>/dev/null || { \
	    echo "ROS_DISTRO is $(ROS_DISTRO), but $(PYTHON) cannot import rclpy, numpy and cv2: source that ROS and run rosdep install," \
	    "or unset ROS_DISTRO to take the wheels" >&2; exit 1; }
