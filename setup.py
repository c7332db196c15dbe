# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Installs lane_dp_ros: by colcon on a robot, by pip elsewhere."""

from glob import glob

from setuptools import find_packages, setup

NAME = "lane_dp_ros"
OPENCV = "opencv-python-headless>=4.6"

setup(
    name=NAME,
    version="0.1.0",
    description="Stereo lane detection by dynamic programming, for ROS 2 Jazzy and as a library",
    maintainer="The lane_dp_ros authors",
    maintainer_email="lane_dp_ros@example.org",
    license="Apache-2.0",
    packages=find_packages(include=[NAME, f"{NAME}.*"]),
    package_data={
        f"{NAME}.core.lanes": ["evidence.json"],
        f"{NAME}.review": ["static/*"],
        f"{NAME}.tools.report": ["static/*"],
    },
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/config", sorted(glob("config/*"))),
        (f"share/{NAME}/launch", sorted(glob("launch/*.launch.py"))),
    ],
    python_requires=">=3.10",
    # Neither ROS nor OpenCV: on a robot both come from apt, and a wheel of either would stand in its way.
    install_requires=["numpy>=1.26", "rosbags>=0.11.7", "tqdm"],
    extras_require={
        "opencv": [OPENCV],
        # Jazzy's rclpy, Fast DDS and messages; PyPI's bare ros-* names are of another distribution.
        "ros": [OPENCV, "pyyaml", "ros-jazzy-rclpy[fastrtps]==7.1.6", "ros-jazzy-common-interfaces==5.3.6"],
        "test": [
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
            "lane_detector = lane_dp_ros.ros.lane_detector_node:main",
            "lane_dp = lane_dp_ros.tools.cli:main",
        ]
    },
    zip_safe=True,
)
