# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Installs lane_dp_ros: by colcon on a robot, by pip elsewhere."""

import os
from glob import glob
from pathlib import Path

from setuptools import find_packages, setup

NAME = "lane_dp_ros"
URL = "https://example.org/lane_dp_ros"
# colcon and bloom install no requirements, so these do not stand in apt's way there. pip does; where a ROS is
# sourced they are that ROS's: a wheel would hide its OpenCV and bring a numpy 2 that Jazzy's messages refuse.
OPENCV_AND_YAML = [] if "ROS_DISTRO" in os.environ else ["opencv-python-headless>=4.6", "pyyaml"]

setup(
    name=NAME,
    version="0.2.0",
    description="Stereo lane detection by dynamic programming, for ROS 2 Jazzy and as a library",
    long_description=Path(__file__).with_name("README.md").read_text(encoding="utf-8"),
    long_description_content_type="text/markdown",
    url=URL,
    project_urls={
        "Source": URL,
        "Documentation": f"{URL}/docs",
        "Issues": f"{URL}/issues",
        "Changes": f"{URL}/CHANGELOG.rst",
    },
    maintainer="The lane_dp_ros authors",
    maintainer_email="lane_dp_ros@example.org",
    license="Apache-2.0",
    keywords=["lane detection", "stereo vision", "dynamic programming", "ROS 2", "autonomous driving"],
    classifiers=[
        "Development Status :: 4 - Beta",
        "Environment :: Console",
        "Intended Audience :: Developers",
        "Intended Audience :: Science/Research",
        "Operating System :: POSIX :: Linux",
        "Programming Language :: Python :: 3",
        "Programming Language :: Python :: 3.10",
        "Programming Language :: Python :: 3.11",
        "Programming Language :: Python :: 3.12",
        "Programming Language :: Python :: 3.13",
        "Topic :: Scientific/Engineering :: Image Recognition",
        "Typing :: Typed",
    ],
    packages=find_packages(include=[NAME, f"{NAME}.*"]),
    package_data={
        NAME: ["py.typed"],
        f"{NAME}.core.lanes": ["evidence.json"],
        f"{NAME}.review": ["static/*"],
        f"{NAME}.tools.report": ["static/*"],
    },
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/config", sorted(path for path in glob("config/*") if os.path.isfile(path))),
        (f"share/{NAME}/config/cameras", sorted(glob("config/cameras/*.yaml"))),
        (f"share/{NAME}/launch", sorted(glob("launch/*.launch.py"))),
    ],
    python_requires=">=3.10",
    install_requires=["numpy>=1.26", "rosbags>=0.11.7", "tqdm", *OPENCV_AND_YAML],
    extras_require={
        # Jazzy's rclpy, Fast DDS and messages; PyPI's bare ros-* names are of another distribution.
        "ros": ["ros-jazzy-rclpy[fastrtps]==7.1.6", "ros-jazzy-common-interfaces==5.3.6"],
        "completion": ["argcomplete"],
        "test": [
            "argcomplete",
            "hypothesis",
            "mcap-ros2-support",
            "pyarrow",
            "pytest",
            "pytest-cov",
            "pytest-xdist",
            "pyyaml",
            "rosbags-image",
            "scipy",
            "selenium",
        ],
        "fit": ["scipy"],
        "parquet": ["pyarrow"],
        "bench": ["matplotlib", "scikit-image", "scipy"],
        "docs": [
            "matplotlib",
            "myst-parser>=4",
            "sphinx>=8",
            "sphinx-argparse>=0.5",
            "sphinx-copybutton",
            "sphinx-rtd-theme>=3",
            "sphinxcontrib-mermaid",
        ],
        "lint": ["import-linter==2.11", "mypy==2.4.1", "ruff==0.17.6"],
    },
    entry_points={
        "console_scripts": [
            "lane_detector = lane_dp_ros.ros.start:main",
            "lane_dp = lane_dp_ros.tools.cli:main",
        ]
    },
    zip_safe=True,
)
